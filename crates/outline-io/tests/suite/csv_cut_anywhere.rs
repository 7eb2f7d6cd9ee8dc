//! A file reads the same wherever the reads of its source end: byte by byte, when no row is ever seen whole and the csv
//! crate reads them all, or in any other pieces.
use std::io::{self, Read};

use freeform_outline_io::OutlineReader;
use proptest::prelude::*;

/// Returns as many bytes per call as the sizes say, in turn.
struct InPieces<'a> {
    text: &'a [u8],
    sizes: std::iter::Cycle<std::slice::Iter<'a, usize>>,
}

impl<'a> InPieces<'a> {
    fn new(text: &'a [u8], sizes: &'a [usize]) -> Self {
        Self { text, sizes: sizes.iter().cycle() }
    }
}

impl Read for InPieces<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let most = self.sizes.next().map_or(1, |&size| size).min(buffer.len());
        self.text.read(&mut buffer[..most])
    }
}

/// All frames, to the last bit, and messages.
fn outcome(source: impl Read) -> Vec<String> {
    match OutlineReader::new(source, "test") {
        Err(error) => vec![error.to_string()],
        Ok(reader) => reader.map(|item| item.map_or_else(|e| e.to_string(), |frame| format!("{frame:?}"))).collect(),
    }
}

const HEADERS: [&str; 5] = [
    "frame,time,x,y",
    "frame,time,x,y,object",
    "note,frame,time,x,object,y",
    "arc,y,x,object,time,frame,note",
    "x,y,\"frame\",arc,time",
];

/// One of the texts between the bars.
fn any_of(texts: &'static str) -> impl Strategy<Value = String> {
    prop::sample::select(texts.split('|').collect::<Vec<_>>()).prop_map(str::to_owned)
}

/// Text of a coordinate, most often a plain one.
fn coordinate() -> impl Strategy<Value = String> {
    const ODD: &str = "1e3|+1|-0|1.|.5|-.5|-|.||1.2.3|nan|1e400| 7|7\r|\"8\"|9\"|1\t|#1|0000000000000000001|\
        123456789012345678901234567890|9007199254740993|0.30666634123456789|1,2|2\n3";
    prop_oneof![
        20 => (-1000.0..1000.0_f64).prop_map(|value| format!("{value:.5}")),
        20 => (-1.0..1.0_f64).prop_map(|value| value.to_string()),
        1 => any_of(ODD),
    ]
}

/// Text of another field: so many times as often as an odd one that of the row before, which stands for `None`.
fn other(weight: u32) -> impl Strategy<Value = Option<String>> {
    const ODD: &str = "a,b|\"a,b\"|\"a\"|a\"b|\"\"\"a\"|\"a\nb\"|#a|\"#a\"|| a|a\r|\u{e4}|2|2.0|3";
    prop_oneof![weight => Just(None), 1 => any_of(ODD).prop_map(Some)]
}

/// What a row is made of.
#[derive(Debug, Clone)]
struct RowParts {
    before: String,
    x: String,
    y: String,
    /// Frame, time, object, arc and note.
    others: [Option<String>; 5],
    begins_frame: bool,
    /// The column that is quoted, if there are as many.
    quoted: Option<usize>,
    end: &'static str,
}

fn row_parts() -> impl Strategy<Value = RowParts> {
    let before = prop_oneof![
        30 => Just(String::new()),
        1 => any_of("# comment, \"1\n|\n| \r\n|#\n\n|0,0,1,1\n|\"\n|\""),
    ];
    let end = prop_oneof![12 => Just("\n"), 2 => Just("\r\n"), 1 => Just("\n\n")];
    let others = [other(200), other(200), other(30), other(100), other(10)];
    let begins_frame = prop::bool::weighted(0.15);
    let quoted = prop::option::weighted(0.1, 0..7_usize);
    (before, coordinate(), coordinate(), others, begins_frame, quoted, end).prop_map(
        |(before, x, y, others, begins_frame, quoted, end)| RowParts {
            before,
            x,
            y,
            others,
            begins_frame,
            quoted,
            end,
        },
    )
}

fn file(header: &str, rows: &[RowParts], closed_last: bool) -> String {
    let mut text = format!("{header}\n");
    let (mut frame, mut object, mut arc, mut note) = (0, "wing".to_owned(), String::new(), "1".to_owned());
    for row in rows {
        let [odd_frame, odd_time, new_object, new_arc, new_note] = &row.others;
        frame += u32::from(row.begins_frame);
        for (value, new) in [(&mut object, new_object), (&mut arc, new_arc), (&mut note, new_note)] {
            if let Some(new) = new {
                value.clone_from(new);
            }
        }
        let (number, time) = (frame.to_string(), format!("{frame}.5"));
        let fields: Vec<String> = header
            .split(',')
            .map(|column| match column {
                "time" => odd_time.as_ref().unwrap_or(&time),
                "x" => &row.x,
                "y" => &row.y,
                "object" => &object,
                "arc" => &arc,
                "note" => &note,
                _ => odd_frame.as_ref().unwrap_or(&number),
            })
            .enumerate()
            .map(|(index, field)| match row.quoted == Some(index) {
                true => format!("\"{}\"", field.replace('"', "\"\"")),
                false => field.clone(),
            })
            .collect();
        text += &row.before;
        text += &fields.join(",");
        text += row.end;
    }
    if !closed_last {
        text.truncate(text.trim_end().len());
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]
    #[test]
    fn the_reading_does_not_depend_on_where_the_reads_end(
        header in prop::sample::select(HEADERS.as_slice()),
        rows in prop::collection::vec(row_parts(), 0..40),
        closed_last in any::<bool>(),
        sizes in prop::collection::vec(1..200_usize, 1..8),
        whole in any::<bool>(),
    ) {
        let text = file(header, &rows, closed_last);
        let sizes = if whole { vec![1 << 16] } else { sizes };
        prop_assert_eq!(
            outcome(InPieces::new(text.as_bytes(), &sizes)),
            outcome(InPieces::new(text.as_bytes(), &[1])),
            "{}", text
        );
    }
}

#[test]
fn a_file_longer_than_the_buffer_is_read_whole_and_its_last_line_is_named() {
    let mut text = String::from("note,frame,time,x,y\n");
    for frame in 0..40 {
        for point in 0..200 {
            let angle = f64::from(point) * std::f64::consts::TAU / 200.0;
            text += &format!("{point},{frame},{frame}.25,{},{:.7}\n", angle.cos(), angle.sin());
        }
        text += "# a comment in the midst\n";
    }
    text += "0,40,40,1,one\n";
    assert!(text.len() > 3 << 16, "several times the buffer");
    let whole = outcome(text.as_bytes());
    assert_eq!(whole.len(), 41);
    assert_eq!(whole[40], "test:8042: column y: \"one\" is not a number");
    assert_eq!(whole, outcome(InPieces::new(text.as_bytes(), &[1])));
    assert_eq!(whole, outcome(InPieces::new(text.as_bytes(), &[1009])));
}

#[test]
fn a_comment_is_one_although_its_line_has_the_fields_of_a_row() {
    let text = "note,frame,time,x,y\nn,0,0,0,0\nn,0,0,1,0\n#n,0,0,9,9\nn,0,0,0,1\n";
    assert_eq!(outcome(text.as_bytes()), outcome(text.replace("#n,0,0,9,9\n", "").as_bytes()));
}

#[test]
fn a_row_is_not_taken_for_a_repetition_of_a_quoted_name() {
    let text = "frame,time,x,y,object\n0,0,0,0,\"a,b\"\n0,0,1,0,a,b\n";
    assert_eq!(outcome(text.as_bytes())[1..], ["test:3: 6 field(s), the header has 5"]);
}
