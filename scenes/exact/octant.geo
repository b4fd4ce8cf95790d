// An eighth of a hollow sphere, radii in mm, for scenes/exact/mesh.toml:
//     gmsh -3 -order 2 octant.geo -o octant.msh
// A sphere in the middle of the wall keeps two cells through it.
a = 5; m = 6; b = 7; h = 1.7;
Point(1) = {0, 0, 0, h};
Point(2) = {a, 0, 0, h}; Point(3) = {0, a, 0, h}; Point(4) = {0, 0, a, h};
Point(5) = {b, 0, 0, h}; Point(6) = {0, b, 0, h}; Point(7) = {0, 0, b, h};
Point(8) = {m, 0, 0, h}; Point(9) = {0, m, 0, h}; Point(10) = {0, 0, m, h};
Circle(1) = {2, 1, 3}; Circle(2) = {3, 1, 4}; Circle(3) = {4, 1, 2};
Circle(4) = {5, 1, 6}; Circle(5) = {6, 1, 7}; Circle(6) = {7, 1, 5};
Circle(7) = {8, 1, 9}; Circle(8) = {9, 1, 10}; Circle(9) = {10, 1, 8};
Line(10) = {2, 8}; Line(11) = {3, 9}; Line(12) = {4, 10};
Line(13) = {8, 5}; Line(14) = {9, 6}; Line(15) = {10, 7};
Curve Loop(1) = {1, 2, 3}; Surface(1) = {1};
Curve Loop(2) = {4, 5, 6}; Surface(2) = {2};
Curve Loop(3) = {7, 8, 9}; Surface(3) = {3};
Curve Loop(4) = {1, 11, -7, -10}; Plane Surface(4) = {4};
Curve Loop(5) = {2, 12, -8, -11}; Plane Surface(5) = {5};
Curve Loop(6) = {3, 10, -9, -12}; Plane Surface(6) = {6};
Curve Loop(7) = {7, 14, -4, -13}; Plane Surface(7) = {7};
Curve Loop(8) = {8, 15, -5, -14}; Plane Surface(8) = {8};
Curve Loop(9) = {9, 13, -6, -15}; Plane Surface(9) = {9};
Surface Loop(1) = {1, 3, 4, 5, 6}; Volume(1) = {1};
Surface Loop(2) = {3, 2, 7, 8, 9}; Volume(2) = {2};
Physical Surface("cavity") = {1};
Physical Surface("outer") = {2};
Physical Surface("symmetry_z") = {4, 7};   // the plane z = 0: u_z = 0
Physical Surface("symmetry_x") = {5, 8};
Physical Surface("symmetry_y") = {6, 9};
Physical Volume("elastomer") = {1, 2};
