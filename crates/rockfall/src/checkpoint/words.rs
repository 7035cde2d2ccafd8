//! Reads and writes little-endian numbers.

use glam::Vec3;

/// The reason why a checkpoint is not usable.
#[derive(Debug)]
pub(crate) struct Damage(pub(crate) String);

impl Damage {
    pub(crate) fn new(reason: impl Into<String>) -> Self {
        Self(reason.into())
    }
}

/// From the library's error about an object or a constant.
impl From<crate::Error> for Damage {
    fn from(error: crate::Error) -> Self {
        Self(error.to_string())
    }
}

/// The bytes that are left to read.
pub(crate) struct Words<'a> {
    bytes: &'a [u8],
}

impl<'a> Words<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    /// The bytes of a [`Head::block`].
    pub(crate) fn block(&mut self) -> Result<&'a [u8], Damage> {
        let length = usize::try_from(self.u64()?).map_err(|_| Damage::new("a part of it is too long"))?;
        self.take(length)
    }

    pub(crate) fn take(&mut self, length: usize) -> Result<&'a [u8], Damage> {
        let (taken, rest) = self
            .bytes
            .split_at_checked(length)
            .ok_or_else(|| Damage::new(format!("{length} bytes expected, {} left", self.bytes.len())))?;
        self.bytes = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Damage> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    pub(crate) fn u32(&mut self) -> Result<u32, Damage> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    pub(crate) fn u64(&mut self) -> Result<u64, Damage> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    pub(crate) fn f32(&mut self) -> Result<f32, Damage> {
        Ok(f32::from_bits(self.u32()?))
    }

    pub(crate) fn f64(&mut self) -> Result<f64, Damage> {
        Ok(f64::from_bits(self.u64()?))
    }

    pub(crate) fn bool(&mut self) -> Result<bool, Damage> {
        match self.u32()? {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(Damage::new(format!("a flag is {other}, expected 0 or 1"))),
        }
    }

    /// A number that may be missing, as written by [`Head::known`].
    pub(crate) fn known(&mut self) -> Result<Option<f32>, Damage> {
        let (is_known, number) = (self.bool()?, self.f32()?);
        Ok(is_known.then_some(number))
    }

    pub(crate) fn vec3(&mut self) -> Result<Vec3, Damage> {
        Ok(Vec3::new(self.f32()?, self.f32()?, self.f32()?))
    }

    pub(crate) fn text(&mut self) -> Result<String, Damage> {
        let length = usize::try_from(self.u64()?).map_err(|_| Damage::new("a text is too long"))?;
        let bytes = self.take(length)?.to_vec();
        String::from_utf8(bytes).map_err(|_| Damage::new("a text is not UTF-8"))
    }

    /// Whether no bytes are left.
    pub(crate) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Checks that no bytes are left.
    pub(crate) fn end(&self) -> Result<(), Damage> {
        match self.bytes.len() {
            0 => Ok(()),
            left => Err(Damage::new(format!("it has {left} bytes more than expected"))),
        }
    }
}

/// The bytes of the head, which precede the objects.
#[derive(Default)]
pub(crate) struct Head {
    pub(crate) bytes: Vec<u8>,
}

impl Head {
    /// The length of the bytes, and the bytes.
    pub(crate) fn block(self) -> Vec<u8> {
        let mut all = Self::default();
        all.u64(self.bytes.len() as u64);
        all.bytes.extend(self.bytes);
        all.bytes
    }

    pub(crate) fn u32(&mut self, number: u32) {
        self.bytes.extend(number.to_le_bytes());
    }

    pub(crate) fn u64(&mut self, number: u64) {
        self.bytes.extend(number.to_le_bytes());
    }

    pub(crate) fn f32(&mut self, number: f32) {
        self.u32(number.to_bits());
    }

    /// A number that may be missing: a flag and the number, or 0.
    pub(crate) fn known(&mut self, number: Option<f32>) {
        self.u32(u32::from(number.is_some()));
        self.f32(number.unwrap_or(0.0));
    }

    pub(crate) fn f64(&mut self, number: f64) {
        self.u64(number.to_bits());
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.u64(text.len() as u64);
        self.bytes.extend(text.as_bytes());
    }
}
