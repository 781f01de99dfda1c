//! Plain text tables.

/// Rows in columns two spaces apart, without spaces at line ends; columns of numbers are flush right.
pub(crate) fn render<const COLUMNS: usize>(rows: &[[String; COLUMNS]]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let is_number = |cell: &String| cell.parse::<f64>().is_ok();
    let mut text = String::new();
    for row in rows {
        let cells: Vec<String> = (0..COLUMNS)
            .map(|column| {
                let width = width(column).unwrap_or(0);
                if is_number(&row[column]) {
                    format!("{:>width$}", row[column])
                } else {
                    format!("{:<width$}", row[column])
                }
            })
            .collect();
        text.push_str(cells.join("  ").trim_end());
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let rows = [["scene", "cases"], ["a", "16"], ["cornell", "4"]];
        let rows = rows.map(|row| row.map(String::from));
        assert_eq!(
            render(&rows),
            "scene    cases\na           16\ncornell      4\n"
        );
    }
}
