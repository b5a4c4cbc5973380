// Faces of bracket.step as surface meshes of punch and die. Lengths in mm.
SetFactory("OpenCASCADE");
Merge "bracket.step";
e = 1e-3;
// What the sheet can touch: flats and roundings, then flanks.
punch[] = Surface In BoundingBox {-2 - e, 2 - e, -1 - e, 18 + e, 12 + e, 2 + e};
punch[] += Surface In BoundingBox {18 - e, 12 - e, -1 - e, 18 + e, 32 + e, 2 + e};
die[] = Surface In BoundingBox {30 - e, -10 - e, -1 - e, 60 + e, e, 2 + e};
die[] += Surface In BoundingBox {30 - e, -30 - e, -1 - e, 30 + e, -10 + e, 2 + e};
Physical Surface("punch") = {punch[]};
Physical Surface("die") = {die[]};
Transfinite Curve {:} = 5;                // 4 facets along each edge, roundings, too
Transfinite Surface {punch[], die[]};
Recombine Surface {punch[], die[]};
