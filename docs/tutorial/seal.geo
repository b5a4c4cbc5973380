// A hollow rubber seal, half a tube, and a round bar above it. Lengths in mm.
Point(1) = {0, 0, 0};
Point(2) = {7, 0, 0};  Point(3) = {10, 0, 0};
Point(4) = {0, 7, 0};  Point(5) = {0, 10, 0};
Point(6) = {-7, 0, 0}; Point(7) = {-10, 0, 0};
Circle(1) = {2, 1, 4}; Circle(2) = {4, 1, 6};
Circle(3) = {3, 1, 5}; Circle(4) = {5, 1, 7};
Line(5) = {2, 3}; Line(6) = {4, 5}; Line(7) = {6, 7};
Curve Loop(1) = {5, 3, -6, -1}; Plane Surface(1) = {1};
Curve Loop(2) = {6, 4, -7, -2}; Plane Surface(2) = {2};

// The bar: a third of a cylinder of radius 8 in six facets. It is wider than the seal.
Point(11) = {0, 18, -1};
Point(12) = {-8 * Sqrt(3) / 2, 14, -1};
Point(13) = {8 * Sqrt(3) / 2, 14, -1};
Circle(11) = {12, 11, 13};
Transfinite Curve {11} = 7;

// Hexahedra: a grid of quadrilaterals, extruded by one layer; facets of the bar, longer than the seal.
Transfinite Curve {1, 2, 3, 4} = 25; // 24 elements along each quarter
Transfinite Curve {5, 6, 7} = 5;     // 4 through the wall
Transfinite Surface {1, 2};
Recombine Surface {1, 2};
a[] = Extrude {0, 0, 1} { Surface{1}; Layers{1}; Recombine; };
b[] = Extrude {0, 0, 1} { Surface{2}; Layers{1}; Recombine; };
c[] = Extrude {0, 0, 3} { Curve{11}; Layers{1}; Recombine; };

// The groups that the scene names.
Physical Volume("rubber") = {a[1], b[1]};
Physical Surface("feet") = {a[2], b[4]};
Physical Surface("outside") = {a[3], b[3]};
Physical Surface("bar") = {c[1]};
