//! The tension of a coupled sheet: scale of residuals.

use super::Scratch;
use super::coupled::{CoupledLanes, Law};
use super::forces::{Row, measure_row};
use crate::mesh::lanes::Field;
use crate::model::Tension;
use crate::springs::closed_form::Change;
use wide::f32x4;

/// The tension of the whole cells: what the sheet pulls at the two edges B and L of every cell, squared.
pub(super) fn tension(
    law: &CoupledLanes,
    u: &Field,
    Scratch { layout, border, on_border, row }: &mut Scratch,
) -> Tension {
    let mut sum = 0.0;
    for counted in layout.cell_rows() {
        let (start, count) = (counted.start, counted.groups);
        let row = &mut row[..count];
        let lower = Row::new(u, start, count + 1);
        measure_row(lower, Row::new(u, start + layout.pitch, count + 1), row);
        for (b, cells) in row.iter().enumerate() {
            let [c11, _, c22, _, g12, ..] = cells.changes;
            let [all, q] =
                law.groups().tension(cells.triangles[0], Change::of_square([c11, c22, g12]));
            let (m11, m12, m22) = (all + q * c22, -q * g12, all + q * c11);
            let (g11, g22) = (c11 + f32x4::ONE, c22 + f32x4::ONE);
            let squares = m11 * (m11 * g11 + m12 * g12 * 2.0)
                + m22 * (m22 * g22 + m12 * g12 * 2.0)
                + m12 * m12 * (g11 + g22);
            let counts = counted.counts(b);
            sum += f64::from((squares & counts).reduce_add());
        }
    }
    if layout.cell_rows().next().is_none() {
        // Only a surface that is even has regular cells.
        sum = border.squares(law.groups(), u, on_border);
    }
    Tension { squares: sum, ..Tension::default() }
}
