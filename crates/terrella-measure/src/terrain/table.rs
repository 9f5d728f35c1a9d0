//! Tables, as text and as CSV.

use crate::output::csv_text;

/// A table of words and numbers that are written already.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// The name of its file, without an extension.
    pub name: &'static str,
    /// A sentence about it, with the meaning of the numbers.
    pub title: String,
    /// The columns' heads.
    pub head: Vec<String>,
    /// As long as the head, each.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    pub(super) fn new(name: &'static str, title: impl Into<String>, head: &[&str]) -> Self {
        Self {
            name,
            title: title.into(),
            head: head.iter().map(|word| (*word).to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// The title and the table in Markdown, columns of one width each.
    pub fn to_text(&self) -> String {
        let lines = || std::iter::once(&self.head).chain(&self.rows);
        let width = |column: usize| {
            let words = lines().filter_map(|line| line.get(column));
            words.map(|word| word.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.head.len()).map(width).collect();
        let mut text = format!("{}\n\n", self.title);
        for (row, line) in lines().enumerate() {
            for (word, width) in line.iter().zip(&widths) {
                text += &format!("| {word:>width$} ");
            }
            text += "|\n";
            if row == 0 {
                for width in &widths {
                    text += &format!("|{}", "-".repeat(width + 2));
                }
                text += "|\n";
            }
        }
        text
    }

    /// The table as CSV, its head first.
    pub fn to_csv(&self) -> String {
        csv_text(std::iter::once(&self.head).chain(&self.rows))
    }
}

#[cfg(test)]
mod tests {
    use super::Table;

    #[test]
    fn words_are_aligned_and_quoted() {
        let mut table = Table::new("t", "A table.", &["ground", "size, m"]);
        table.rows.push(vec!["a \"b\"".into(), "1".into()]);
        table.rows.push(vec!["hill".into(), "1234567890".into()]);
        let text = "A table.\n\n| ground |    size, m |\n|--------|------------|\n\
                    |  a \"b\" |          1 |\n|   hill | 1234567890 |\n";
        assert_eq!(table.to_text(), text);
        let csv = "ground,\"size, m\"\n\"a \"\"b\"\"\",1\nhill,1234567890\n";
        assert_eq!(table.to_csv(), csv);
    }
}
