//! Feather tables (Arrow IPC files), as Argoverse 2 has them: converted to a table in text, so that every fact has a place.
//!
//! Owns the decoding, by the crate `arrow-ipc`, and its bounds. Knows nothing of transforms.

use std::fmt::Write;
use std::io::Cursor;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, downcast_dictionary_array};
use arrow_ipc::reader::FileReader;

/// The first bytes of a file.
pub(crate) const MAGIC: &[u8] = b"ARROW1";
/// Bytes that one buffer may unpack to.
const MAX_BUFFER: i64 = 64 << 20;
/// Rows that are read.
const MAX_ROWS: usize = 20_000;

/// The table as CSV: a line of names, a line for each row.
pub fn to_csv(bytes: Vec<u8>) -> Result<String, String> {
    bounded(&bytes)?;
    // The decoder checks its input, but its authors do not promise more for damaged files.
    std::panic::catch_unwind(move || decoded(bytes)).unwrap_or_else(|_| Err("the table is damaged".to_owned()))
}

fn decoded(bytes: Vec<u8>) -> Result<String, String> {
    let broken = |error: arrow_schema::ArrowError| format!("not a readable feather table: {error}");
    let reader = FileReader::try_new(Cursor::new(bytes), None).map_err(broken)?;
    let schema = reader.schema();
    let names: Vec<&str> = schema.fields().iter().map(|field| field.name().as_str()).collect();
    let mut out = names.join(",");
    let mut rows = 0;
    for batch in reader {
        let batch = batch.map_err(broken)?;
        for row in 0..batch.num_rows() {
            rows += 1;
            if rows > MAX_ROWS {
                return Err(format!("the table has more than {MAX_ROWS} rows"));
            }
            out.push('\n');
            for (index, column) in batch.columns().iter().enumerate() {
                let comma = if index == 0 { "" } else { "," };
                let _ = write!(out, "{comma}{}", cell(column.as_ref(), row));
            }
        }
    }
    out.push('\n');
    Ok(out)
}

/// One value as text; empty if there is none, or if no transform needs its type.
fn cell(column: &dyn Array, row: usize) -> String {
    use arrow_schema::DataType;
    if column.is_null(row) {
        return String::new();
    }
    macro_rules! number {
        ($kind:ty) => {
            column
                .as_primitive_opt::<$kind>()
                .map(|values| values.value(row).to_string())
        };
    }
    let text = match column.data_type() {
        DataType::Float64 => number!(Float64Type),
        DataType::Float32 => number!(Float32Type),
        DataType::Int8 => number!(Int8Type),
        DataType::Int16 => number!(Int16Type),
        DataType::Int32 => number!(Int32Type),
        DataType::Int64 => number!(Int64Type),
        DataType::UInt8 => number!(UInt8Type),
        DataType::UInt16 => number!(UInt16Type),
        DataType::UInt32 => number!(UInt32Type),
        DataType::UInt64 => number!(UInt64Type),
        DataType::Utf8 => column.as_string_opt::<i32>().map(|texts| plain(texts.value(row))),
        DataType::LargeUtf8 => column.as_string_opt::<i64>().map(|texts| plain(texts.value(row))),
        DataType::Utf8View => column.as_string_view_opt().map(|texts| plain(texts.value(row))),
        DataType::Dictionary(..) => downcast_dictionary_array!(
            column => column.key(row).map(|key| cell(column.values().as_ref(), key)),
            _ => None,
        ),
        _ => None,
    };
    text.unwrap_or_default()
}

/// A text that does not break the table.
fn plain(text: &str) -> String {
    text.replace([',', ';', '\n', '\r', '"'], "_")
}

/// Refuses files whose packed buffers say that they unpack to more than they may: the decoder would allocate that memory.
fn bounded(bytes: &[u8]) -> Result<(), String> {
    let broken = || "not a readable feather table: its end is missing or damaged".to_owned();
    let tail = bytes.len().checked_sub(10).ok_or_else(broken)?;
    let length = bytes.get(tail..tail + 4).and_then(|length| length.try_into().ok());
    let length = usize::try_from(i32::from_le_bytes(length.ok_or_else(broken)?)).map_err(|_| broken())?;
    let start = tail.checked_sub(length).ok_or_else(broken)?;
    let footer = arrow_ipc::root_as_footer(bytes.get(start..tail).ok_or_else(broken)?).map_err(|_| broken())?;
    let blocks = footer.recordBatches().into_iter().chain(footer.dictionaries());
    for block in blocks.flat_map(|blocks| blocks.iter()) {
        let start = usize::try_from(block.offset()).map_err(|_| broken())?;
        let head = usize::try_from(block.metaDataLength()).map_err(|_| broken())?;
        let body = start.checked_add(head).ok_or_else(broken)?;
        let message = bytes.get(start..body).ok_or_else(broken)?;
        // The decoder allocates as much as a block claims to have.
        let size = usize::try_from(block.bodyLength()).map_err(|_| broken())?;
        if body.checked_add(size).is_none_or(|end| end > bytes.len()) {
            return Err(broken());
        }
        // A message has its length before it, since version 4 after a mark.
        let skip = if message.starts_with(&[0xff; 4]) { 8 } else { 4 };
        let message = arrow_ipc::root_as_message(message.get(skip..).ok_or_else(broken)?).map_err(|_| broken())?;
        let batch = message
            .header_as_record_batch()
            .or_else(|| message.header_as_dictionary_batch()?.data());
        let Some(batch) = batch else { continue };
        let nodes = batch
            .nodes()
            .into_iter()
            .flat_map(|nodes| nodes.iter())
            .map(arrow_ipc::FieldNode::length);
        let is_long = |rows: i64| usize::try_from(rows).is_ok_and(|rows| rows > MAX_ROWS);
        if nodes.chain([batch.length()]).any(is_long) {
            return Err(format!("the table has more than {MAX_ROWS} rows"));
        }
        if batch.compression().is_none() {
            continue;
        }
        for buffer in batch.buffers().into_iter().flat_map(|buffers| buffers.iter()) {
            let at = usize::try_from(buffer.offset())
                .ok()
                .and_then(|offset| body.checked_add(offset));
            let size = at
                .and_then(|at| bytes.get(at..at.checked_add(8)?))
                .and_then(|size| size.try_into().ok());
            if buffer.length() >= 8 && size.is_some_and(|size| i64::from_le_bytes(size) > MAX_BUFFER) {
                return Err("the table unpacks to more than 64 MB".to_owned());
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use arrow_array::{ArrayRef, DictionaryArray, Float64Array, RecordBatch, StringArray};
    use arrow_ipc::writer::{FileWriter, IpcWriteOptions};

    use super::*;

    /// A table as pandas writes it: texts as a dictionary or plainly, packed by lz4.
    pub(crate) fn table(is_packed: bool) -> Vec<u8> {
        let names: ArrayRef = if is_packed {
            let names: DictionaryArray<Int8Type> = ["ring_front_center", "up_lidar"].into_iter().collect();
            Arc::new(names)
        } else {
            Arc::new(StringArray::from(vec!["ring_front_center", "up_lidar"]))
        };
        let qw: ArrayRef = Arc::new(Float64Array::from(vec![Some(0.5), None]));
        let batch = RecordBatch::try_from_iter([("sensor_name", names), ("qw", qw)]).unwrap();
        let packed = is_packed.then_some(arrow_ipc::CompressionType::LZ4_FRAME);
        let options = IpcWriteOptions::default().try_with_compression(packed).unwrap();
        let mut writer = FileWriter::try_new_with_options(Vec::new(), &batch.schema(), options).unwrap();
        writer.write(&batch).unwrap();
        writer.into_inner().unwrap()
    }

    #[test]
    fn tables_become_text() {
        for is_packed in [false, true] {
            assert_eq!(
                to_csv(table(is_packed)).unwrap(),
                "sensor_name,qw\nring_front_center,0.5\nup_lidar,\n"
            );
        }
    }

    #[test]
    fn broken_tables_are_refused_and_none_asks_for_much_memory() {
        let whole = table(true);
        for end in 0..whole.len() {
            assert!(to_csv(whole[..end].to_vec()).is_err(), "cut at {end}");
        }
        for at in 0..whole.len() {
            for value in [0, 0x7f, 0xff] {
                let mut bytes = whole.clone();
                bytes[at] = value;
                let _ = to_csv(bytes);
            }
        }
    }
}
