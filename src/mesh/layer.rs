//! Bodies of one layer of hexahedra along z, in plane strain or axisymmetric.

use super::{Mesh, Solid, SolidShape};
use crate::error::{Error, Location, Result};

/// For each node the node under it, or itself where it is the lower one. Renumbers every hexahedron so that its first four
/// nodes are the lower ones, counter-clockwise seen from +z, and the last four stand above them in the same order.
///
/// # Errors
/// Anything but one layer of hexahedra with straight edges along z; `at` is where the user asked for it by
/// `key`.
pub fn tie_layer(mesh: &mut Mesh, key: &str, at: &Location) -> Result<Vec<u32>> {
    const HELP: &str = "extrude the mesh by one element along z";
    let instead = if key == "plane_strain" { ", or fix u_z in the steps instead" } else { "" };
    let refuse = |what: String| {
        let what = format!("`{key}` needs one layer of hexahedra along z: {what}");
        Err(Error::input(at, what, format!("{HELP}{instead}")))
    };
    let mut tie: Vec<u32> = (0..mesh.points.len() as u32).collect();
    let mut above = vec![None; mesh.points.len()];
    for solid in &mesh.solids {
        if solid.shape != SolidShape::Hex8 {
            return refuse(format!("element {} is none", solid.id));
        }
        for &a in solid.nodes() {
            for &b in solid.nodes() {
                let (p, q) = (mesh.points[a as usize], mesh.points[b as usize]);
                let height = q[2] - p[2];
                if height > 0.0 && (p[0] - q[0]).hypot(p[1] - q[1]) < 1e-8 * height {
                    tie[b as usize] = a;
                    above[a as usize] = Some(b);
                }
            }
        }
    }
    let is_lower = |n: u32| tie[n as usize] == n;
    if let Some(k) = (0..tie.len()).find(|&k| is_lower(k as u32) == above[k].is_none()) {
        let of =
            if is_lower(k as u32) { "no other straight above or below it" } else { "others both above and below it" };
        return refuse(format!("node {} has {of}", mesh.point_ids[k]));
    }
    for solid in &mut mesh.solids {
        match lower_face(solid, is_lower) {
            Some(lower) => {
                let height = |n: u32| {
                    let [low, high] = [n, above[n as usize].unwrap_or_default()].map(|n| mesh.points[n as usize][2]);
                    high - low
                };
                let thickness = height(lower[0]);
                if lower.iter().any(|&n| (height(n) - thickness).abs() > 1e-6 * thickness) {
                    return refuse(format!("element {} is thicker on one side", solid.id));
                }
                for k in 0..4 {
                    (solid.nodes[k], solid.nodes[k + 4]) = (lower[k], above[lower[k] as usize].unwrap_or_default());
                }
            }
            None => return refuse(format!("element {} does not stand upright", solid.id)),
        }
    }
    Ok(tie)
}

/// The face whose nodes are all lower ones, counter-clockwise seen from inside the element.
fn lower_face(solid: &Solid, is_lower: impl Fn(u32) -> bool) -> Option<[u32; 4]> {
    let faces = (0..solid.shape.face_count()).map(|f| solid.face(f));
    faces.map(|face| face.reversed().nodes).find(|nodes| nodes.iter().all(|&n| is_lower(n)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn here() -> Location {
        Location { file: "scene.toml".into(), line: 3, column: 1, text: "".into() }
    }

    /// A hexahedron whose extrusion runs along its first local axis.
    fn lying() -> Mesh {
        let upright = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        let points = upright.map(|[x, y, z]| [f64::from(y), f64::from(z), f64::from(x)]);
        let solid = Solid::new(SolidShape::Hex8, &[0, 1, 2, 3, 4, 5, 6, 7], 7);
        Mesh { points: points.to_vec(), point_ids: (1..=8).collect(), solids: vec![solid], ..Mesh::default() }
    }

    #[test]
    fn elements_are_renumbered_to_stand_on_their_lower_face() {
        let mut mesh = lying();
        let tie = tie_layer(&mut mesh, "plane_strain", &here()).unwrap();
        let nodes = mesh.solids[0].nodes;
        let at = |k: usize| crate::Vec3::from(mesh.points[nodes[k] as usize]);
        for k in 0..4 {
            assert_eq!(tie[nodes[k + 4] as usize], nodes[k]);
            assert_eq!(at(k + 4) - at(k), crate::Vec3::z());
        }
        assert!((at(1) - at(0)).cross(&(at(3) - at(0))).z > 0.0);
    }

    #[test]
    fn what_is_not_one_layer_is_named() {
        let mut mesh = lying();
        mesh.points[1][0] += 0.1;
        let text = tie_layer(&mut mesh, "plane_strain", &here()).unwrap_err().to_string();
        assert!(text.contains("one layer of hexahedra along z: node 1 has no other straight above"), "{text}");
        let mut mesh = lying();
        let top = (0..8).find(|&k| mesh.points[k][2] > 0.5).unwrap_or_default();
        mesh.points[top][2] += 0.01;
        let text = tie_layer(&mut mesh, "plane_strain", &here()).unwrap_err().to_string();
        assert!(text.contains("element 7 is thicker on one side"), "{text}");
    }
}
