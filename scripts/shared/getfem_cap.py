"""A rigid cap that is pressed on an elastic block and drawn along it, in GetFEM: an augmented Lagrangian for contact
with friction at large sliding, its projection by ray tracing. A program of scripts/studies/peers.py: reads the case as
JSON from the standard input and writes JSON, of each increment the step, the iterations and the force on the block."""

import json
import sys

import getfem as gf
import numpy as np

HEXAHEDRON = "FEM_QK(3,1)"
GAUSS_2, GAUSS_3 = "IM_GAUSS_PARALLELEPIPED(3,3)", "IM_GAUSS_PARALLELEPIPED(3,5)"  # points in each direction
BOTTOM, TOP = 101, 102  # numbers of regions


def read(file):
    """A mesh with regions below and on top, displacements on it, and integration over it."""
    mesh = gf.Mesh("import", "gmsh", file)
    for region, direction in ((BOTTOM, [0, 0, -1]), (TOP, [0, 0, 1])):
        mesh.set_region(region, mesh.outer_faces_with_direction(direction, np.pi / 4))
    space = gf.MeshFem(mesh, 3)
    space.set_fem(gf.Fem(HEXAHEDRON))
    return mesh, space, gf.MeshIm(mesh, gf.Integ(GAUSS_3))


def main():
    gf.util("trace level", 0)
    case = json.load(sys.stdin)
    block, space, faces = read(case["block"])
    cap, cap_space, cap_faces = read(case["cap"])
    young, poisson = case["young"], case["poisson"]

    model = gf.Model("real")
    model.add_fem_variable("u", space)
    model.add_filtered_fem_variable("stress", space, TOP)
    lame = [young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 + 2 * poisson)]
    model.add_initialized_data("lame", lame)
    inside = gf.MeshIm(block, gf.Integ(GAUSS_2))
    model.add_finite_strain_elasticity_brick(inside, "Compressible Neo Hookean Bonet", "u", "lame")
    model.add_initialized_fem_data("held", space, np.zeros(space.nbdof()))
    model.add_Dirichlet_condition_with_simplification("u", BOTTOM, "held")

    # The cap is rigid: all of its nodes are moved.
    cap.set_region(1, cap.outer_faces())
    model.add_fem_variable("cap", cap_space)
    for name, on in (("given", cap_space), ("cap_before", cap_space), ("u_before", space)):
        model.add_initialized_fem_data(name, on, np.zeros(on.nbdof()))
    model.add_Dirichlet_condition_with_simplification("cap", 1, "given")

    element = case["element"]
    for name, value in (("r", young / element), ("friction", case["friction"]), ("alpha", 1.0)):
        model.add_initialized_data(name, value)
    contact = model.add_integral_large_sliding_contact_brick_raytracing("r", 2 * element, "friction", "alpha")
    model.add_slave_contact_boundary_to_large_sliding_contact_brick(contact, faces, TOP, "u", "stress", "u_before")
    model.add_master_contact_boundary_to_large_sliding_contact_brick(contact, cap_faces, BOTTOM, "cap", "cap_before")

    place, rows = np.zeros(3), []
    for step, by, increments in case["steps"]:
        for _ in range(increments):
            place += np.array(by) / increments
            model.set_variable("given", np.tile(place, cap_space.nbdof() // 3))
            iterations, converged = model.solve("lsolver", "mumps", "lsearch", "simplest", "max_res", 1e-7,
                                                "max_iter", 50)
            if not converged:
                sys.exit(f"step {step}: no convergence in {iterations} iterations")
            force = [float(gf.asm_generic(faces, 0, f"stress({k})", TOP, model)) for k in (1, 2, 3)]
            rows.append((step, iterations, force))
            for name in ("u", "cap"):
                model.set_variable(f"{name}_before", model.variable(name))
    json.dump(rows, sys.stdout)


if __name__ == "__main__":
    main()
