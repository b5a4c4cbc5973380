//! Solid mechanics: elements and materials as pure functions on fixed-size arrays.
//!
//! [`material`] gives stress and tangent at a point, [`element`] integrates them over an element, [`history`] keeps what
//! points remember, [`load`] has the loads on faces. Stresses are in the unit of the moduli, forces in that unit times length squared.

mod eigen;
pub mod element;
pub mod history;
pub mod load;
pub mod material;
pub mod measure;
pub mod voigt;

#[cfg(test)]
pub(crate) mod testing;
