//! Lloyd's relaxation with exact Voronoi cells.

use glam::DVec2;

use crate::pattern::Boundary;
use crate::sorting::order;

/// Moves every point to the centroid of its Voronoi cell in `[0, size.x) × [0, size.y)` (Lloyd 1982): one step of the
/// fixed-point iteration whose limit is a centroidal Voronoi tessellation.
///
/// In a periodic domain the cells are those of the torus and results are wrapped back; in an open one they are cut
/// off at the border. Cells are clipped exactly, half-plane by half-plane, at a cost of O(n²) distance tests: meant
/// for exemplars of a few hundred points, not for syntheses.
#[must_use]
pub fn lloyd_step(points: &[DVec2], size: DVec2, boundary: Boundary) -> Vec<DVec2> {
    let mut cell = Vec::new();
    let mut clipped = Vec::new();
    let mut others: Vec<(f64, DVec2)> = Vec::new();
    (0..points.len())
        .map(|index| {
            let site = points[index];
            // Coordinates relative to the site; on the torus no cell reaches beyond half a period.
            let (low, high) = match boundary {
                Boundary::Periodic => (-0.5 * size, 0.5 * size),
                Boundary::Open => (-site, size - site),
            };
            cell.clear();
            cell.extend([low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)]);
            others.clear();
            for (other, &point) in points.iter().enumerate() {
                if other == index {
                    continue;
                }
                let offset = point - site;
                match boundary {
                    Boundary::Open => others.push((offset.length_squared(), offset)),
                    Boundary::Periodic => {
                        for shift_y in [-1.0, 0.0, 1.0] {
                            for shift_x in [-1.0, 0.0, 1.0] {
                                let image = offset + DVec2::new(shift_x, shift_y) * size;
                                others.push((image.length_squared(), image));
                            }
                        }
                    }
                }
            }
            let nearest_first = order(others.iter().map(|other| other.0));
            for (distance_squared, offset) in nearest_first.into_iter().map(|place| others[place]) {
                let reach = cell.iter().map(|corner: &DVec2| corner.length_squared()).fold(0.0, f64::max);
                // A bisector farther away than every corner can't cut; nor can any later one.
                if distance_squared > 4.0 * reach {
                    break;
                }
                if distance_squared > 0.0 {
                    clip(&cell, offset, 0.5 * distance_squared, &mut clipped);
                    std::mem::swap(&mut cell, &mut clipped);
                }
            }
            let moved = site + centroid(&cell);
            if boundary == Boundary::Periodic { wrap(moved, size) } else { moved.clamp(DVec2::ZERO, size) }
        })
        .collect()
}

/// The point of `[0, size.x) × [0, size.y)` that is the same as `point` on the torus.
#[must_use]
pub fn wrap(point: DVec2, size: DVec2) -> DVec2 {
    let wrapped = point - (point / size).floor() * size;
    // Rounding can land exactly on the far border, which is the near one.
    DVec2::select(wrapped.cmpge(size) | wrapped.cmplt(DVec2::ZERO), DVec2::ZERO, wrapped)
}

/// The part of a convex polygon where `corner · normal ≤ limit` (Sutherland & Hodgman 1974).
fn clip(polygon: &[DVec2], normal: DVec2, limit: f64, result: &mut Vec<DVec2>) {
    result.clear();
    for (index, &from) in polygon.iter().enumerate() {
        let to = polygon[(index + 1) % polygon.len()];
        let (before, after) = (from.dot(normal) - limit, to.dot(normal) - limit);
        if before <= 0.0 {
            result.push(from);
        }
        if (before < 0.0 && after > 0.0) || (before > 0.0 && after < 0.0) {
            result.push(from + (to - from) * (before / (before - after)));
        }
    }
}

/// Centre of mass of a polygon around the origin; the origin itself where there is no area.
fn centroid(polygon: &[DVec2]) -> DVec2 {
    let mut area = 0.0;
    let mut moment = DVec2::ZERO;
    for (index, &from) in polygon.iter().enumerate() {
        let to = polygon[(index + 1) % polygon.len()];
        let cross = from.perp_dot(to);
        area += cross;
        moment += (from + to) * cross;
    }
    if area > 0.0 { moment / (3.0 * area) } else { DVec2::ZERO }
}
