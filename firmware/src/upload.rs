//! A model on its way in: too large for a frame, so it comes in pieces.

use pliant_protocol::checksum;
use pliant_protocol::message::UploadError;
use pliant_protocol::model::{MODEL_MAX, Model};

/// The model being uploaded, if one is.
#[derive(Debug)]
pub(crate) struct Upload {
    bytes: heapless::Vec<u8, MODEL_MAX>,
    announced: Option<Announced>,
}

#[derive(Clone, Copy, Debug)]
struct Announced {
    len: usize,
    crc: u32,
}

impl Upload {
    pub(crate) const fn new() -> Self {
        Self { bytes: heapless::Vec::new(), announced: None }
    }

    /// A model of `len` bytes follows; what was uploaded of another is forgotten.
    pub(crate) fn begin(&mut self, len: u32, crc: u32) -> Result<(), UploadError> {
        self.bytes.clear();
        self.announced = None;
        let len = usize::try_from(len).map_err(|_| UploadError::TooLarge)?;
        if len > MODEL_MAX {
            return Err(UploadError::TooLarge);
        }
        self.announced = Some(Announced { len, crc });
        Ok(())
    }

    /// The piece at `offset`. One that is there already (its answer was lost, the host sent it again) is welcome.
    pub(crate) fn chunk(&mut self, offset: u32, data: &[u8]) -> Result<(), UploadError> {
        let announced = self.announced.ok_or(UploadError::NotBegun)?;
        let offset = usize::try_from(offset).map_err(|_| UploadError::TooLarge)?;
        let end = offset.checked_add(data.len()).ok_or(UploadError::TooLarge)?;
        if end > announced.len {
            return Err(UploadError::TooLarge);
        }
        if self.bytes.get(offset..end) == Some(data) {
            return Ok(());
        }
        if offset != self.bytes.len() {
            return Err(UploadError::Gap);
        }
        self.bytes.extend_from_slice(data).map_err(|_| UploadError::TooLarge)
    }

    /// The whole model; the upload is over, whatever comes of it.
    pub(crate) fn commit(&mut self) -> Result<Model, UploadError> {
        let announced = self.announced.take().ok_or(UploadError::NotBegun)?;
        if self.bytes.len() != announced.len {
            return Err(UploadError::Incomplete);
        }
        if checksum(&self.bytes) != announced.crc {
            return Err(UploadError::Crc);
        }
        Model::from_bytes(&self.bytes).map_err(|_| UploadError::Malformed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pliant_protocol::model::Motion;

    #[test]
    fn every_way_an_upload_can_go_wrong() {
        let model = Model { dimension: 2, motion: Motion::Linear { attractor: [0.0; 3], gain: 1.0 } };
        let mut room = [0; MODEL_MAX];
        let bytes = model.to_bytes(&mut room).unwrap();
        let (len, crc) = (bytes.len() as u32, checksum(bytes));
        let mut upload = Upload::new();
        assert_eq!(upload.chunk(0, bytes), Err(UploadError::NotBegun));
        assert_eq!(upload.commit(), Err(UploadError::NotBegun));
        assert_eq!(upload.begin(MODEL_MAX as u32 + 1, 0), Err(UploadError::TooLarge));
        assert_eq!(upload.begin(len, crc), Ok(()));
        assert_eq!(upload.chunk(4, &bytes[4..]), Err(UploadError::Gap));
        assert_eq!(upload.chunk(0, &[0; MODEL_MAX]), Err(UploadError::TooLarge));
        assert_eq!(upload.chunk(u32::MAX, bytes), Err(UploadError::TooLarge));
        assert_eq!(upload.chunk(0, &bytes[..4]), Ok(()));
        assert_eq!(upload.chunk(0, &bytes[..4]), Ok(()), "sent twice");
        assert_eq!(upload.commit(), Err(UploadError::Incomplete));
        assert_eq!(upload.begin(len, !crc), Ok(()));
        assert_eq!(upload.chunk(0, bytes), Ok(()));
        assert_eq!(upload.commit(), Err(UploadError::Crc));
        assert_eq!(upload.begin(2, checksum(&[9, 9])), Ok(()));
        assert_eq!(upload.chunk(0, &[9, 9]), Ok(()));
        assert_eq!(upload.commit(), Err(UploadError::Malformed));
        assert_eq!(upload.begin(len, crc), Ok(()));
        assert_eq!(upload.chunk(0, bytes), Ok(()));
        assert_eq!(upload.commit(), Ok(model));
    }
}
