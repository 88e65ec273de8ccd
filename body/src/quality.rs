//! Figures of a fit, and what they say in words.

use crate::chest::Quadric;
use crate::grid::Grid;
use std::f64::consts::TAU;

/// Distance from the pocket up to which holes matter \[mm\].
const BESIDE_POCKET_MM: f64 = 10.0;
/// Reach of the figures about the implant's centre \[mm\].
const NEAR_MM: f64 = 60.0;

/// Figures of a fit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Quality {
    /// Share of the patch without skin in the scan, before holes are filled \[%\].
    pub no_skin_percent: f64,
    /// Share of the patch that determines the chest \[%\].
    pub data_percent: f64,
    /// Share of each eighth of the patch that determines the chest, from x on towards y \[-\].
    pub sectors: [f64; 8],
    /// Least radius of curvature of the chest at the implant's centre \[mm\]; infinite: flat, negative: hollow.
    pub radius_across_mm: f64,
    /// Radius of curvature at right angles to it \[mm\].
    pub radius_along_mm: f64,
    /// Root mean square of the data's distances from the quadric \[mm\].
    pub residual_mm: f64,
    /// Volume between skin and bare chest inside of the breast's ellipse \[ml\].
    pub footprint_ml: f64,
    /// Least, median and greatest thickness within 60 mm, along z \[mm\].
    pub thickness_mm: [f64; 3],
    /// Least and greatest height of the wall within 60 mm over the skin at the implant's centre \[mm\].
    pub wall_mm: [f64; 2],
    /// Share of the patch where the surface overhangs \[%\].
    pub overhang_percent: f64,
    /// Air under the overhang, which counts as tissue \[ml\].
    pub air_ml: f64,
    /// Number of holes that were filled.
    pub holes: usize,
    /// Share of the nodes within 10 mm of the pocket that are without skin after holes are filled \[%\].
    pub open_pocket_percent: f64,
    /// Share of the triangles within 100 mm of the implant's centre that face inwards, of a surface with holes in the pocket \[%\].
    pub inwards_percent: f64,
    /// Distance from the notch to the nipple \[mm\].
    pub notch_nipple_mm: f64,
    /// Angle of the frame's z against the body's front about the head's axis, positive towards the patient's left \[degrees\].
    pub yaw_degrees: f64,
    /// Angle of the frame's z upwards \[degrees\].
    pub pitch_degrees: f64,
    /// Are the surface's normals inwards, so that they were turned round?
    pub is_turned: bool,
    /// The mark farthest off the surface, and its distance \[mm\]; `None`: all lie on it, within 15 mm.
    pub off_skin: Option<(String, f64)>,
    /// Height of a proposed centre of the implant above the nipple, along the body \[mm\]; of a marked one 0.
    pub above_nipple_mm: f64,
}

/// A height field with its nodes.
pub(crate) struct Scan<'a> {
    /// Heights of the skin before holes are filled \[mm\], NaN where there is none.
    pub(crate) heights_mm: &'a [f64],
    /// The same after holes are filled.
    pub(crate) filled_mm: &'a [f64],
    /// Is a node in the ellipse of the breast?
    pub(crate) is_own: &'a [bool],
    /// Does a node determine the chest?
    pub(crate) is_data: &'a [bool],
}

impl Quality {
    /// Figures by their names in Python and JavaScript.
    #[must_use]
    pub fn figures(&self) -> [(&'static str, f64); 7] {
        [
            ("no_skin_percent", self.no_skin_percent),
            ("data_percent", self.data_percent),
            ("radius_across_mm", self.radius_across_mm),
            ("radius_along_mm", self.radius_along_mm),
            ("residual_mm", self.residual_mm),
            ("footprint_ml", self.footprint_ml),
            ("air_ml", self.air_ml),
        ]
    }

    /// The figures of skin, bare chest and wall over a patch.
    pub(crate) fn of_fields(
        grid: Grid,
        scan: &Scan<'_>,
        [skin, bare, wall]: [&[f64]; 3],
        quadric: &Quadric,
        (patch_radius_mm, pocket_radius_mm): (f64, f64),
    ) -> Self {
        let within =
            |radius: f64| (0..grid.len()).filter(move |node| grid.place(*node).length() <= radius);
        let (mut nodes, mut data, mut open) = (0.0, 0.0, 0.0);
        let (mut of_sector, mut data_of_sector) = ([0.0; 8], [0.0; 8]);
        let mut squares = 0.0;
        for node in within(patch_radius_mm) {
            let place = grid.place(node);
            let sector = (place.to_angle().rem_euclid(TAU) / TAU * 8.0) as usize % 8;
            nodes += 1.0;
            of_sector[sector] += 1.0;
            open += f64::from(u8::from(scan.heights_mm[node].is_nan()));
            if scan.is_data[node] {
                data += 1.0;
                data_of_sector[sector] += 1.0;
                squares += (scan.heights_mm[node] - quadric.at(place)).powi(2);
            }
        }
        let mut thickness: Vec<f64> = within(NEAR_MM).map(|node| skin[node] - wall[node]).collect();
        thickness.sort_unstable_by(f64::total_cmp);
        let heights = within(NEAR_MM).map(|node| wall[node] - skin[grid.len() / 2]);
        let footprint = (0..grid.len()).filter(|node| scan.is_own[*node]);
        let footprint = footprint.map(|node| skin[node] - bare[node]).sum::<f64>();
        let [radius_across_mm, radius_along_mm] = quadric.radii_mm();
        Self {
            no_skin_percent: 100.0 * open / nodes,
            data_percent: 100.0 * data / nodes,
            sectors: std::array::from_fn(|k| data_of_sector[k] / of_sector[k]),
            radius_across_mm,
            radius_along_mm,
            residual_mm: (squares / data).sqrt(),
            footprint_ml: footprint * grid.spacing_mm.powi(2) / 1e3,
            thickness_mm: [
                thickness[0],
                thickness[thickness.len() / 2],
                thickness[thickness.len() - 1],
            ],
            wall_mm: [heights.clone().fold(f64::MAX, f64::min), heights.fold(f64::MIN, f64::max)],
            open_pocket_percent: open_percent(grid, scan.filled_mm, pocket_radius_mm),
            ..Self::default()
        }
    }
}

impl Quality {
    /// Sets the figures of overhang from the depths of air \[mm\].
    pub(crate) fn set_air(&mut self, grid: Grid, air: &[f64], patch_radius_mm: f64) {
        let is_within = |node: &usize| grid.place(*node).length() <= patch_radius_mm;
        let nodes = (0..grid.len()).filter(is_within);
        let hanging = nodes.clone().filter(|node| air[*node] > 0.0);
        self.overhang_percent = 100.0 * hanging.clone().count() as f64 / nodes.count() as f64;
        let depths: f64 = hanging.map(|node| air[node]).sum();
        self.air_ml = depths * grid.spacing_mm.powi(2) / 1e3;
    }
}

/// Share of the nodes within 10 mm of a pocket that are without skin after holes are filled \[%\].
fn open_percent(grid: Grid, filled_mm: &[f64], pocket_radius_mm: f64) -> f64 {
    let reach = pocket_radius_mm + BESIDE_POCKET_MM;
    let near = (0..grid.len()).filter(|node| grid.place(*node).length() <= reach);
    let open = near.clone().filter(|node| filled_mm[*node].is_nan()).count();
    100.0 * open as f64 / near.count() as f64
}

/// Is there skin over a pocket?
pub(crate) fn carries_pocket(grid: Grid, filled_mm: &[f64], pocket_radius_mm: f64) -> bool {
    open_percent(grid, filled_mm, pocket_radius_mm) <= limits::OPEN_POCKET_PERCENT
}

/// Limits of the figures, beyond which a sentence says what is wrong.
mod limits {
    /// Least share of data in the patch \[%\].
    pub(super) const DATA_PERCENT: f64 = 30.0;
    /// Least share of data in an eighth of the patch \[-\], and the number of eighths below it that is too high.
    pub(super) const SECTOR: (f64, usize) = (0.1, 3);
    /// Greatest share of the patch without skin \[%\].
    pub(super) const NO_SKIN_PERCENT: f64 = 10.0;
    /// Greatest share without skin near the pocket \[%\].
    pub(super) const OPEN_POCKET_PERCENT: f64 = 0.5;
    /// Share of the triangles that face inwards above which they may be why \[%\].
    pub(super) const INWARDS_PERCENT: f64 = 2.0;
    /// Least radius of curvature \[mm\].
    pub(super) const RADIUS_MM: (f64, f64) = (90.0, 250.0);
    /// Greatest root mean square of the data's distances from the quadric \[mm\].
    pub(super) const RESIDUAL_MM: f64 = 6.0;
    /// Volume in the breast's ellipse \[ml\].
    pub(super) const FOOTPRINT_ML: (f64, f64) = (30.0, 1500.0);
    /// Greatest height of a proposed centre of the implant above the nipple \[mm\].
    pub(super) const ABOVE_NIPPLE_MM: f64 = 15.0;
    /// Distance from notch to nipple \[mm\].
    pub(super) const NOTCH_NIPPLE_MM: (f64, f64) = (120.0, 400.0);
    /// Greatest overhang of the patch \[%\] and of air \[ml\].
    pub(super) const OVERHANG: (f64, f64) = (5.0, 60.0);
}

impl Quality {
    /// Sentences on figures that make a fit uncertain.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut found = Vec::new();
        if let Some((mark, distance)) = &self.off_skin {
            found.push(format!("{mark} is {distance:.0} mm off the skin: check the mark."));
        }
        if self.above_nipple_mm > limits::ABOVE_NIPPLE_MM {
            found.push(format!(
                "The implant's proposed centre is {:.0} mm above the nipple: move the implant down, or lower the fold.",
                self.above_nipple_mm
            ));
        }
        let (share, most) = limits::SECTOR;
        let empty = self.sectors.iter().filter(|of| **of < share).count();
        if self.data_percent < limits::DATA_PERCENT || empty >= most {
            found.push(format!(
                "The scan shows too little chest around the breast ({:.0} % of the patch): the wall is uncertain by 6 mm or more.",
                self.data_percent
            ));
        }
        if self.no_skin_percent > limits::NO_SKIN_PERCENT {
            found.push(format!(
                "The scan ends inside of the operating field: {:.0} % of the patch has no skin.",
                self.no_skin_percent
            ));
        }
        let (least, most) = limits::RADIUS_MM;
        let radius = self.radius_across_mm;
        if !(least..=most).contains(&radius) {
            found.push(format!(
                "Unusual chest, check the marks: its radius across is {radius:.0} mm, usual are {least:.0} to {most:.0} mm."
            ));
        } else if self.residual_mm > limits::RESIDUAL_MM {
            found.push(format!(
                "Unusual chest, check the marks: the skin beside the breasts is {:.0} mm (root mean square) off a smooth chest.",
                self.residual_mm
            ));
        }
        if self.air_ml > 0.5 {
            found.push(format!(
                "The breast hangs over its fold: {:.0} ml of air under it count as tissue.",
                self.air_ml
            ));
        }
        if self.holes > 0 {
            found.push(format!("Holes of the scan up to 40 mm across, filled: {}.", self.holes));
        }
        if self.is_turned {
            found.push("Turned round: the surface was inside out.".to_owned());
        }
        found
    }

    /// Why a body is not fitted: figures beyond what the method is made for.
    pub(crate) fn error(&self) -> Option<String> {
        let (least, most) = limits::NOTCH_NIPPLE_MM;
        if !(least..=most).contains(&self.notch_nipple_mm) {
            let value = 0.1 * self.notch_nipple_mm;
            let (least, most) = (0.1 * least, 0.1 * most);
            return Some(format!(
                "notch to nipple is {value:.1} cm; allowed: {least:.0} to {most:.0} cm: check unit and marks"
            ));
        }
        let (least, most) = limits::FOOTPRINT_ML;
        if !(least..=most).contains(&self.footprint_ml) {
            let value = self.footprint_ml;
            return Some(format!(
                "the breast has {value:.0} ml over its chest; allowed: {least:.0} to {most:.0} ml: check unit and marks"
            ));
        }
        let (open, most) = (self.open_pocket_percent, limits::OPEN_POCKET_PERCENT);
        if open > most && self.inwards_percent > limits::INWARDS_PERCENT {
            return Some(format!(
                "{open:.1} % of the pocket has no skin, and {:.0} % of the triangles about it face inwards; allowed: {most} %: turn those triangles, or check scan and marks",
                self.inwards_percent
            ));
        }
        if open > most {
            return Some(format!(
                "the scan ends inside of the operating field: {open:.1} % of the pocket has no skin; allowed: {most} %: check scan and marks"
            ));
        }
        let (percent, air) = limits::OVERHANG;
        (self.overhang_percent > percent || self.air_ml > air).then(|| {
            format!(
                "the breast hangs over its fold: {:.1} % of the patch, {:.0} ml of air; allowed: {percent} %, {air} ml: this preview is not made for it",
                self.overhang_percent, self.air_ml
            )
        })
    }
}
