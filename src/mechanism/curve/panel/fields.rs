//! The fields of a panel as a record.
use super::Panel;
use crate::codec::record::{Damaged, Record};
use crate::numerics::chebyshev::NODES;

impl Panel {
    /// Write the panel, or read the fields of a panel with so many coordinates.
    pub fn fields(&mut self, record: &mut Record, coordinates: usize) -> Result<(), Damaged> {
        for vector in [&mut self.base, &mut self.normal, &mut self.tip] {
            vector.resize(coordinates, 0.0);
            record.all_finite("panel", vector)?;
        }
        record.finite("start of a panel", &mut self.start)?;
        record.positive("width of a panel", &mut self.width)?;
        record.finite("half of a panel", &mut self.half)?;
        record.positive("span of a panel", &mut self.span)?;
        record.all_finite("speeds of a panel", &mut self.end_speeds)?;
        record.positive("amplification of a panel", &mut self.amplification)?;
        for series in [&mut self.length, &mut self.speed, &mut self.amplifications] {
            record.all_finite("series of a panel", series)?;
        }
        record.arrays("coordinates of a panel", &mut self.coordinates)?;
        let mut derivatives: Vec<[f64; NODES]> = self.derivatives.iter().flatten().copied().collect();
        record.arrays("derivatives of a panel", &mut derivatives)?;
        record.arrays("curvatures of a panel", &mut self.curvatures)?;
        let (pairs, odd) = derivatives.as_chunks();
        self.derivatives = pairs.to_vec();
        let is_whole = odd.is_empty() && (pairs.is_empty() || pairs.len() == coordinates);
        if !is_whole || [self.coordinates.len(), self.curvatures.len()] != [coordinates; 2] {
            return Err(Damaged::new(
                "a saved section of the motion has another number of coordinates than this mechanism",
            ));
        }
        record.flag("bridged", &mut self.bridged)?;
        record.option("crossing", &mut self.crossing, || 0.0, |record, x| record.finite("crossing", x))
    }

    /// A panel without coordinates, whose fields are to be read.
    pub fn blank() -> Self {
        Self {
            start: 0.0,
            base: Vec::new(),
            normal: Vec::new(),
            width: 1.0,
            coordinates: Vec::new(),
            half: 0.0,
            length: [0.0; NODES],
            span: 1.0,
            speed: [0.0; NODES],
            end_speeds: [0.0; 2],
            tip: Vec::new(),
            amplification: 1.0,
            amplifications: [0.0; NODES],
            derivatives: Vec::new(),
            curvatures: Vec::new(),
            bridged: false,
            crossing: None,
        }
    }
}
