//! Masses of shapes and bodies in space.
//!
//! In: shapes with their sizes. Out: mass, centre and tensor of inertia.

use super::spatial::{Rotation, Vector, add, after, dot, scaled};
use anyhow::{Result, bail};
use std::f64::consts::PI;

/// Mass, centre, and tensor of inertia about the centre by its columns, in the global frame.
pub type Part = (f64, Vector, [Vector; 3]);

/// A homogeneous shape about its centre, with its axis of revolution along z.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    Sphere(f64),
    /// Radius and length.
    Cylinder(f64, f64),
    /// Radius and length of the cylinder between the half spheres.
    Capsule(f64, f64),
    /// Lengths of the sides.
    Cuboid(Vector),
    /// Half axes.
    Ellipsoid(Vector),
}

impl Shape {
    /// Volume [m3], and moments of inertia for a mass of 1.
    pub fn solid(self) -> (f64, Vector) {
        match self {
            Self::Sphere(r) => (4.0 / 3.0 * PI * r.powi(3), [0.4 * r * r; 3]),
            Self::Cylinder(r, h) => {
                let across = (3.0 * r * r + h * h) / 12.0;
                (PI * r * r * h, [across, across, 0.5 * r * r])
            }
            Self::Capsule(r, h) => {
                let (cylinder, balls) = (PI * r * r * h, 4.0 / 3.0 * PI * r.powi(3));
                let volume = cylinder + balls;
                let (c, b) = (cylinder / volume, balls / volume);
                let across = c * (h * h / 12.0 + r * r / 4.0) + b * (0.4 * r * r + 0.25 * h * h + 0.375 * h * r);
                (volume, [across, across, c * 0.5 * r * r + b * 0.4 * r * r])
            }
            Self::Cuboid([x, y, z]) => (x * y * z, [y * y + z * z, x * x + z * z, x * x + y * y].map(|sum| sum / 12.0)),
            Self::Ellipsoid([a, b, c]) => {
                (4.0 / 3.0 * PI * a * b * c, [b * b + c * c, a * a + c * c, a * a + b * b].map(|sum| 0.2 * sum))
            }
        }
    }

    /// Mass properties for a mass, or for a density [kg/m3], at a position.
    pub fn part(self, mass: Option<f64>, density: f64, place: Vector, rotation: &Rotation) -> Part {
        let (volume, [x, y, z]) = self.solid();
        let mass = mass.unwrap_or(volume * density);
        let own = [[mass * x, 0.0, 0.0], [0.0, mass * y, 0.0], [0.0, 0.0, mass * z]];
        (mass, place, in_space(rotation, &own))
    }
}

/// A tensor in the global frame.
pub fn in_space(rotation: &Rotation, own: &[Vector; 3]) -> [Vector; 3] {
    let back: Rotation = std::array::from_fn(|k| [rotation[0][k], rotation[1][k], rotation[2][k]]);
    after(rotation, &after(own, &back))
}

/// A symmetric tensor from its six numbers xx, yy, zz, xy, xz, yz.
pub fn symmetric([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> [Vector; 3] {
    [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
}

/// Mass, centre and inertia of several parts.
pub fn together(parts: &[Part]) -> Part {
    let mass: f64 = parts.iter().map(|(mass, ..)| mass).sum();
    if mass <= 0.0 {
        return (0.0, [0.0; 3], [[0.0; 3]; 3]);
    }
    let weighted = parts.iter().fold([0.0; 3], |sum, (own, center, _)| add(sum, scaled(*center, *own)));
    let center = scaled(weighted, 1.0 / mass);
    let mut inertia = [[0.0; 3]; 3];
    for (own, place, tensor) in parts {
        let d = add(*place, scaled(center, -1.0));
        let square = dot(d, d);
        for (k, column) in inertia.iter_mut().enumerate() {
            for (j, entry) in column.iter_mut().enumerate() {
                *entry += tensor[k][j] + own * (if j == k { square } else { 0.0 } - d[j] * d[k]);
            }
        }
    }
    (mass, center, inertia)
}

/// Mass properties with lower bounds of the mass and of the principal moments of inertia.
///
/// # Errors
/// A moment of inertia may be below the bound, and the principal axes are not the axes of the frame.
pub fn bounded((mass, center, mut inertia): Part, least_mass: f64, least_inertia: f64) -> Result<Part> {
    let off = |k: usize| (0..3).filter(|&j| j != k).map(|j| inertia[k][j].abs()).sum::<f64>();
    let size = (0..3).map(|k| inertia[k][k]).fold(0.0, f64::max);
    if least_inertia > 0.0 && (0..3).any(|k| inertia[k][k] - off(k) < least_inertia) {
        if least_inertia > 0.0 && (0..3).any(|k| off(k) > 1e-9 * size) {
            bail!("boundinertia may act on this body: write its moments of inertia and remove boundinertia");
        }
        (0..3).for_each(|k| inertia[k][k] = inertia[k][k].max(least_inertia));
    }
    Ok((mass.max(least_mass), center, inertia))
}
