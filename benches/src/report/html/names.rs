//! Short names of contenders: what all of a kind have in common is left out.

use std::collections::BTreeSet;

use super::super::Contender;
use super::mark::OWN_LIBRARY;

/// Knows all contenders, and so what tells them apart.
#[derive(Clone, Debug)]
pub(super) struct Names {
    contenders: BTreeSet<Contender>,
}

impl Names {
    pub(super) const fn new(contenders: BTreeSet<Contender>) -> Self {
        Self { contenders }
    }

    /// `bvh` for a structure of the project; `other` or `other bvh` for another library, and `bvh library` for one of that name.
    pub(super) fn structure(&self, contender: &Contender) -> String {
        if contender.library == OWN_LIBRARY {
            return contender.structure.clone();
        }
        let mut others = self.contenders.iter();
        let has_others = others.any(|other| {
            other.library == contender.library && other.structure != contender.structure
        });
        let is_own_name = |other: &Contender| {
            other.library == OWN_LIBRARY && other.structure == contender.library
        };
        if has_others {
            format!("{} {}", contender.library, contender.structure)
        } else if self.contenders.iter().any(is_own_name) {
            format!("{} library", contender.library)
        } else {
            contender.library.clone()
        }
    }

    /// The structure, and its preset if there are several.
    pub(super) fn build(&self, contender: &Contender) -> String {
        let name = self.structure(contender);
        if self.varies(contender, |contender| &contender.preset) {
            format!("{name} ({})", contender.preset)
        } else {
            name
        }
    }

    /// The structure and all that tells the contender from others.
    pub(super) fn full(&self, contender: &Contender) -> String {
        let mut name = self.build(contender);
        let is_own = contender.library == OWN_LIBRARY;
        if is_own || self.varies(contender, |contender| &contender.precision) {
            name = format!("{name} {}", contender.precision);
        }
        self.with_way(contender, name)
    }

    /// The structure and all that tells the contender from others, but not the precision.
    pub(super) fn without_precision(&self, contender: &Contender) -> String {
        self.with_way(contender, self.build(contender))
    }

    fn with_way(&self, contender: &Contender, mut name: String) -> String {
        if self.varies(contender, |contender| &contender.simd) {
            name = format!("{name} {}", contender.simd);
        }
        let is_only_way = !self.varies(contender, |contender| &contender.interface);
        if is_only_way || contender.interface == "single" {
            name
        } else {
            format!("{name} {}", contender.interface)
        }
    }

    /// Whether contenders of the same library and structure differ in something.
    fn varies(&self, contender: &Contender, of: impl Fn(&Contender) -> &String) -> bool {
        self.contenders.iter().any(|other| {
            other.library == contender.library
                && other.structure == contender.structure
                && of(other) != of(contender)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contender(library: &str, structure: &str, precision: &str, interface: &str) -> Contender {
        Contender {
            library: library.to_owned(),
            structure: structure.to_owned(),
            preset: "best".to_owned(),
            precision: precision.to_owned(),
            simd: "avx2".to_owned(),
            interface: interface.to_owned(),
        }
    }

    #[test]
    fn a_name_says_what_tells_a_contender_from_others() {
        let contenders = [
            contender("tahko", "bvh", "exact", "single"),
            contender("tahko", "bvh", "exact", "batch"),
            contender("tahko", "bsp", "exact", "single"),
            contender("peer", "tree", "default", "single"),
            contender("bvh", "bvh", "default", "single"),
            contender("pair", "bvh", "robust", "single"),
            contender("pair", "grid", "robust", "packet16"),
        ];
        let names = Names::new(contenders.iter().cloned().collect());
        assert_eq!(
            contenders.map(|contender| names.full(&contender)),
            [
                "bvh exact",
                "bvh exact batch",
                "bsp exact",
                "peer",
                "bvh library",
                "pair bvh",
                "pair grid"
            ]
        );
    }
}
