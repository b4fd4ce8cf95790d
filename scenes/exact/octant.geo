// An eighth of a hollow sphere, radii in mm, for scenes/exact/mesh.toml:
//     gmsh -3 -order 2 octant.geo -o octant.msh
a = 5; b = 7; h = 1.7;
Point(1) = {0, 0, 0, h};
Point(2) = {a, 0, 0, h}; Point(3) = {0, a, 0, h}; Point(4) = {0, 0, a, h};
Point(5) = {b, 0, 0, h}; Point(6) = {0, b, 0, h}; Point(7) = {0, 0, b, h};
Circle(1) = {2, 1, 3}; Circle(2) = {3, 1, 4}; Circle(3) = {4, 1, 2};
Circle(4) = {5, 1, 6}; Circle(5) = {6, 1, 7}; Circle(6) = {7, 1, 5};
Line(7) = {2, 5}; Line(8) = {3, 6}; Line(9) = {4, 7};
Curve Loop(1) = {1, 2, 3}; Surface(1) = {1};
Curve Loop(2) = {4, 5, 6}; Surface(2) = {2};
Curve Loop(3) = {1, 8, -4, -7}; Plane Surface(3) = {3};
Curve Loop(4) = {2, 9, -5, -8}; Plane Surface(4) = {4};
Curve Loop(5) = {3, 7, -6, -9}; Plane Surface(5) = {5};
Surface Loop(1) = {1, 2, 3, 4, 5}; Volume(1) = {1};
Physical Surface("cavity") = {1};
Physical Surface("outer") = {2};
Physical Surface("symmetry_z") = {3};   // the plane z = 0: u_z = 0
Physical Surface("symmetry_x") = {4};
Physical Surface("symmetry_y") = {5};
Physical Volume("elastomer") = {1};
