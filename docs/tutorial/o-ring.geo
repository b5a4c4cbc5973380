// An O-ring of 5.33 mm, its section in one layer, and the groove that it lies in. Lengths in mm.
r = 5.33 / 2; c = 0.5 * r / Sqrt(2);   // radius of the section, half side of its core
q = r / Sqrt(2);
Point(1) = {0, 0, 0};
Point(2) = {-c, -c, 0}; Point(3) = {c, -c, 0}; Point(4) = {c, c, 0}; Point(5) = {-c, c, 0};
Point(6) = {-q, -q, 0}; Point(7) = {q, -q, 0}; Point(8) = {q, q, 0}; Point(9) = {-q, q, 0};
Line(1) = {2, 3}; Line(2) = {3, 4}; Line(3) = {4, 5}; Line(4) = {5, 2};
Circle(5) = {6, 1, 7}; Circle(6) = {7, 1, 8}; Circle(7) = {8, 1, 9}; Circle(8) = {9, 1, 6};
Line(9) = {2, 6}; Line(10) = {3, 7}; Line(11) = {4, 8}; Line(12) = {5, 9};
Curve Loop(1) = {1, 2, 3, 4};    Plane Surface(1) = {1};
Curve Loop(2) = {9, 5, -10, -1}; Plane Surface(2) = {2};
Curve Loop(3) = {10, 6, -11, -2}; Plane Surface(3) = {3};
Curve Loop(4) = {11, 7, -12, -3}; Plane Surface(4) = {4};
Curve Loop(5) = {12, 8, -9, -4}; Plane Surface(5) = {5};
Transfinite Curve {1:8} = 17;    // 16 elements along a quarter
Transfinite Curve {9:12} = 7;    // 6 from the core to the outside
Transfinite Surface {1:5};
Recombine Surface {1:5};
ring[] = Extrude {0, 0, 0.4} { Surface{1:5}; Layers{1}; Recombine; };

// The groove: half as wide as w, its floor under the ring, corners of radius e.
w = 3.2; e = 0.5; f = -r; h = f + 4.2;
Point(121) = {-w, h, 0.6}; Point(122) = {-w, f + e, 0.6}; Point(123) = {-w + e, f, 0.6};
Point(124) = {w - e, f, 0.6}; Point(125) = {w, f + e, 0.6}; Point(126) = {w, h, 0.6};
Point(127) = {-w + e, f + e, 0.6}; Point(128) = {w - e, f + e, 0.6};
Line(121) = {121, 122}; Line(123) = {123, 124}; Line(125) = {125, 126};
Circle(122) = {122, 127, 123}; Circle(124) = {124, 128, 125};
Transfinite Curve {122, 124} = 4;      // 3 facets in a corner
Transfinite Curve {121, 123, 125} = 5;
groove[] = Extrude {0, 0, -0.8} { Curve{121:125}; Layers{1}; Recombine; };

// The groups that the scene names.
Physical Volume("rubber") = {ring[1], ring[7], ring[13], ring[19], ring[25]};
Physical Surface("outside") = {ring[9], ring[15], ring[21], ring[27]};
Physical Surface("fluid") = {ring[27]};
Physical Surface("groove") = {groove[1], groove[5], groove[9], groove[13], groove[17]};
