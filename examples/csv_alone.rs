//! Reads an outline file with the csv crate alone and parses frame, x and y of every row: what `freeform identify` is
//! to be measured against.
//!
//! ```sh
//! cargo run --release --example csv_alone outlines.csv
//! ```
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: csv_alone FILE")?;
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path)?;
    let header = reader.byte_headers()?.clone();
    let column =
        |name: &str| header.iter().position(|field| field == name.as_bytes()).ok_or(format!("no column {name}"));
    let columns = [column("frame")?, column("x")?, column("y")?];
    let mut row = csv::ByteRecord::new();
    let (mut rows, mut sum) = (0_u64, 0.0);
    while reader.read_byte_record(&mut row)? {
        for index in columns {
            sum += std::str::from_utf8(&row[index])?.parse::<f64>()?;
        }
        rows += 1;
    }
    println!("{rows} rows, sum {sum}");
    Ok(())
}
