//! The treatment of tiny numbers that Embree asks of the threads that call it.

#[cfg(target_arch = "x86_64")]
pub(super) use x86::FlushDenormals;

/// While it lives, this thread takes denormal numbers for zero where the processor can: see the one for `x86_64`.
#[cfg(not(target_arch = "x86_64"))]
pub(super) struct FlushDenormals(());

#[cfg(not(target_arch = "x86_64"))]
impl FlushDenormals {
    pub(super) fn new() -> Self {
        Self(())
    }
}

#[cfg(target_arch = "x86_64")]
#[expect(
    unsafe_code,
    reason = "only instructions of the processor reach the register"
)]
mod x86 {
    use std::arch::asm;
    use std::marker::PhantomData;

    /// Results that are denormal become zero.
    const FTZ: u32 = 1 << 15;
    /// Denormal operands count as zero.
    const DAZ: u32 = 1 << 6;

    /// While it lives, this thread takes denormal numbers for zero, as Embree asks of its callers.
    pub(in crate::peers::embree) struct FlushDenormals {
        before: u32,
        /// The register is the thread's: no other may restore it.
        not_send: PhantomData<*const ()>,
    }

    impl FlushDenormals {
        pub(in crate::peers::embree) fn new() -> Self {
            let before = read();
            write(before | FTZ | DAZ);
            Self {
                before,
                not_send: PhantomData,
            }
        }
    }

    impl Drop for FlushDenormals {
        fn drop(&mut self) {
            write(self.before);
        }
    }

    pub(super) fn read() -> u32 {
        let mut register = 0_u32;
        // SAFETY: `stmxcsr` writes the four bytes that it is given, and needs SSE, which all x86-64 processors have.
        unsafe {
            asm!("stmxcsr [{}]", in(reg) &raw mut register, options(nostack, preserves_flags));
        }
        register
    }

    fn write(register: u32) {
        // SAFETY: the value was read from the register, but for two bits that may be set on any x86-64 processor: no exception is unmasked.
        // The compiler takes the register to have its default. Between the two calls of this function the code of this module only copies
        // numbers and calls Embree; neither is changed by the two bits, and the drop restores them on every way out.
        unsafe {
            asm!("ldmxcsr [{}]", in(reg) &raw const register, options(nostack, preserves_flags));
        }
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn the_register_is_restored() {
            let before = read();
            {
                let _flush = FlushDenormals::new();
                assert_eq!(read() & (FTZ | DAZ), FTZ | DAZ);
            }
            assert_eq!(read(), before);
        }
    }
}
