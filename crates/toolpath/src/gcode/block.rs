//! Words of one line, each at most once, codes of one modal group at most once.
use super::codes::{self, GeneralCode, MiscCode};
use super::modal::MotionMode;
use super::refusal::{GcodeRefusal, RefusalKind, refusal};

/// Greatest absolute value of a word.
pub(super) const GREATEST: f64 = 1e6;

/// Word with a value, not a code.
#[derive(Clone, Copy, Debug)]
pub(super) struct ValueWord<'a> {
    /// Value as written.
    pub(super) value: f64,
    /// Letter and number.
    pub(super) text: &'a str,
}

/// Code as looked up.
#[derive(Clone, Copy, Debug)]
pub(super) struct CodeWord<'a, C> {
    pub(super) code: C,
    /// Letter and number.
    pub(super) text: &'a str,
}

/// Words of one line.
#[derive(Debug)]
pub(super) struct Block<'a> {
    /// Line, from 1.
    pub(super) number: u32,
    values: [Option<ValueWord<'a>>; LETTERS.len()],
    /// G codes in the order of the line.
    general: [Option<CodeWord<'a, GeneralCode>>; GROUPS],
    /// M codes in the order of the line.
    miscellaneous: [Option<CodeWord<'a, MiscCode>>; MISC_GROUPS],
    /// Modal groups that have a code.
    groups: u32,
}

/// Letters of values.
const LETTERS: [u8; 15] = *b"AFHIJKLPQRSTXYZ";
/// Number of modal groups of G codes, so the most G codes in a line.
const GROUPS: usize = 12;
/// Number of modal groups of M codes.
const MISC_GROUPS: usize = 6;

impl<'a> Block<'a> {
    pub(super) fn new(number: u32) -> Self {
        Self {
            number,
            values: [None; LETTERS.len()],
            general: [None; GROUPS],
            miscellaneous: [None; MISC_GROUPS],
            groups: 0,
        }
    }

    /// Adds a word. Refuses unknown letters and codes, a second word of a letter or group, and absurd values.
    pub(super) fn add(&mut self, text: &'a str) -> Result<(), GcodeRefusal> {
        let letter = text.as_bytes().first().map_or(0, u8::to_ascii_uppercase);
        let digits = text.get(1..).unwrap_or_default();
        match letter {
            b'G' => {
                let tenths = self.tenths(text, digits)?;
                let code = codes::general(tenths)
                    .map_err(|reason| self.refuse(no_code(tenths), text, reason))?;
                let is_second =
                    takes_axes(code) && self.general().any(|word| takes_axes(word.code));
                let kind = match is_second {
                    true => RefusalKind::AxisConflict,
                    false => RefusalKind::ModalGroup,
                };
                self.take_group(codes::group(code), kind, text)?;
                if is_second {
                    let reason = "two codes take the axis words; put each into a line of its own";
                    return Err(self.refuse(kind, text, reason));
                }
                put(&mut self.general, CodeWord { code, text });
            }
            b'M' => {
                let tenths = self.tenths(text, digits)?;
                let code = codes::miscellaneous(tenths).map_err(|reason| {
                    let kind = match tenths % 10 {
                        0 => RefusalKind::Unsupported,
                        _ => RefusalKind::NotWhole,
                    };
                    self.refuse(kind, text, reason)
                })?;
                self.take_group(
                    codes::miscellaneous_group(code),
                    RefusalKind::ModalGroup,
                    text,
                )?;
                put(&mut self.miscellaneous, CodeWord { code, text });
            }
            letter => self.add_value(letter, digits, text)?,
        }
        Ok(())
    }

    /// Word of the letter, upper case.
    pub(super) fn value(&self, letter: u8) -> Option<ValueWord<'a>> {
        let index = LETTERS.iter().position(|l| *l == letter)?;
        self.values.get(index).copied().flatten()
    }

    /// G codes in the order of the line.
    pub(super) fn general(&self) -> impl Iterator<Item = CodeWord<'a, GeneralCode>> + '_ {
        self.general.iter().map_while(|word| *word)
    }

    /// M codes in the order of the line.
    pub(super) fn miscellaneous(&self) -> impl Iterator<Item = CodeWord<'a, MiscCode>> + '_ {
        self.miscellaneous.iter().map_while(|word| *word)
    }

    /// Tells a line without any word, or with a line number alone.
    pub(super) fn is_empty(&self) -> bool {
        self.groups == 0 && self.values.iter().all(Option::is_none)
    }

    /// Refusal of a word of this line.
    pub(super) fn refuse(&self, kind: RefusalKind, word: &str, reason: &str) -> GcodeRefusal {
        refusal(kind, self.number, word, reason)
    }

    fn add_value(&mut self, letter: u8, digits: &str, text: &'a str) -> Result<(), GcodeRefusal> {
        let Some(index) = LETTERS.iter().position(|l| *l == letter) else {
            let waits = |word: CodeWord<'_, MiscCode>| word.code == MiscCode::Input;
            let reason = match letter {
                b'E' if self.miscellaneous().any(waits) => {
                    "E names an analog input; the inputs here have two levels: name one by P"
                }
                letter => unknown_letter(letter),
            };
            return Err(self.refuse(RefusalKind::Unsupported, text, reason));
        };
        let value = match digits.parse::<f64>() {
            // Also refuses what overflows to infinity.
            Ok(value) if value.abs() <= GREATEST => value,
            Ok(_) => {
                return Err(self.refuse(
                    RefusalKind::TooLarge,
                    text,
                    "the value is beyond 1,000,000",
                ));
            }
            Err(_) => return Err(self.refuse(RefusalKind::Number, text, "this is not a number")),
        };
        match self.values.get_mut(index) {
            Some(place @ None) => *place = Some(ValueWord { value, text }),
            _ => {
                return Err(self.refuse(
                    RefusalKind::Repeated,
                    text,
                    "the letter stands in the line already; use a line for each",
                ));
            }
        }
        if value < 0.0
            && let Some(what) = not_negative(letter)
        {
            let reason = format!("{what} is not negative");
            return Err(self.refuse(RefusalKind::Negative, text, &reason));
        }
        Ok(())
    }

    /// Ten times the number of a code.
    fn tenths(&self, text: &str, digits: &str) -> Result<u32, GcodeRefusal> {
        let (whole, tenth) = digits.split_once('.').unwrap_or((digits, "0"));
        let number = match (whole.parse::<u32>(), tenth.as_bytes()) {
            (Ok(whole), [tenth @ b'0'..=b'9']) => whole
                .checked_mul(10)
                .and_then(|tenths| tenths.checked_add(u32::from(tenth - b'0'))),
            _ => None,
        };
        number.ok_or_else(|| {
            self.refuse(
                RefusalKind::NotWhole,
                text,
                "codes are whole numbers, or have one digit behind the point",
            )
        })
    }

    fn take_group(
        &mut self,
        group: u32,
        kind: RefusalKind,
        text: &str,
    ) -> Result<(), GcodeRefusal> {
        let mask = 1 << group;
        if self.groups & mask != 0 {
            return Err(self.refuse(
                kind,
                text,
                "the line has another code of the same modal group; use a line for each",
            ));
        }
        self.groups |= mask;
        Ok(())
    }
}

/// Puts a word into the first free place. There is one for each group.
fn put<T>(places: &mut [Option<T>], word: T) {
    if let Some(place) = places.iter_mut().find(|place| place.is_none()) {
        *place = Some(word);
    }
}

/// Tells codes that the axis words of their line belong to.
fn takes_axes(code: GeneralCode) -> bool {
    match code {
        GeneralCode::Motion(motion) => motion != MotionMode::None,
        GeneralCode::Once(once) => once.takes_axes(),
        _ => false,
    }
}

/// Sense of a letter whose value is not negative.
fn not_negative(letter: u8) -> Option<&'static str> {
    Some(match letter {
        b'F' => "a feed",
        b'P' => "P: a time, a number or a tolerance",
        b'S' => "a power",
        _ => return None,
    })
}

/// Kind of a G code that there is not, by ten times its number: a fraction that the code does not have, or no such code at all.
fn no_code(tenths: u32) -> RefusalKind {
    let whole = tenths / 10;
    // Codes with fractions of their own, some of which are not supported.
    let has_fractions = matches!(whole, 28 | 30 | 43 | 61 | 64 | 90 | 91 | 92);
    match !tenths.is_multiple_of(10) && !has_fractions && codes::general(whole * 10).is_ok() {
        true => RefusalKind::NotWhole,
        false => RefusalKind::Unsupported,
    }
}

/// Reason to refuse a number of a table of tools.
pub(super) const NO_TABLE: &str = "there is no tool table; remove the word";

fn unknown_letter(letter: u8) -> &'static str {
    match letter {
        b'E' => "the machine has no extruder; remove the word",
        b'B' | b'C' | b'U' | b'V' | b'W' => "the machine has no such axis; axes are X, Y and A",
        b'D' => NO_TABLE,
        _ => "words with this letter are not supported; remove the word",
    }
}
