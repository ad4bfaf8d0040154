//! Tables as Feather files, as Argoverse 2 reads them.

use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray};
use arrow_ipc::writer::FileWriter;

/// A table in text, with a header line, as a Feather file: a column of numbers where all its fields are numbers.
///
/// # Errors
///
/// Where a row has fewer fields than the header, in words.
pub fn from_csv(text: &str) -> Result<Vec<u8>, String> {
    let mut lines = text.lines().filter(|line| !line.is_empty());
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let column = |index: usize| -> Result<ArrayRef, String> {
        let fields: Option<Vec<&str>> = rows.iter().map(|row| row.get(index).copied()).collect();
        let fields = fields.ok_or("a row has fewer fields than the header line")?;
        let numbers: Option<Vec<f64>> = fields.iter().map(|field| field.parse().ok()).collect();
        Ok(match numbers {
            Some(numbers) => Arc::new(Float64Array::from(numbers)),
            None => Arc::new(StringArray::from(fields)),
        })
    };
    let columns: Result<Vec<(&str, ArrayRef)>, String> = names
        .iter()
        .enumerate()
        .map(|(index, name)| Ok((*name, column(index)?)))
        .collect();
    let batch = RecordBatch::try_from_iter(columns?).map_err(|error| error.to_string())?;
    let write = || {
        let mut writer = FileWriter::try_new(Vec::new(), &batch.schema())?;
        writer.write(&batch)?;
        writer.into_inner()
    };
    write().map_err(|error| error.to_string())
}
