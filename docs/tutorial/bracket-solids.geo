// Punch and die of a U-shaped bracket, right halves, as solids; `gmsh -0` writes bracket.step. Lengths in mm.
SetFactory("OpenCASCADE");
Box(1) = {-2, 2, -1, 20, 30, 3};          // punch, rounded with 10 mm
Box(2) = {30, -30, -1, 30, 30, 3};        // die, rounded with 10 mm
p[] = Curve In BoundingBox {17.9, 1.9, -2, 18.1, 2.1, 3};
d[] = Curve In BoundingBox {29.9, -0.1, -2, 30.1, 0.1, 3};
Fillet {1} {p[]} {10}
Fillet {2} {d[]} {10}
Save "bracket.step";
