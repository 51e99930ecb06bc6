// SPDX-License-Identifier: BSD-3-Clause
// Modelling in code: vectors, poses, triangle meshes and the handful of builders that the demo's robot and kitchen are made
// of.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace kitchen
{

constexpr double pi = 3.14159265358979323846;

struct Vec3
{
	double x = 0, y = 0, z = 0;
};

inline Vec3 operator+( Vec3 a, Vec3 b )
{
	return { a.x + b.x, a.y + b.y, a.z + b.z };
}
inline Vec3 operator-( Vec3 a, Vec3 b )
{
	return { a.x - b.x, a.y - b.y, a.z - b.z };
}
inline Vec3 operator*( double s, Vec3 a )
{
	return { s * a.x, s * a.y, s * a.z };
}
inline double dot( Vec3 a, Vec3 b )
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec3 cross( Vec3 a, Vec3 b );
double length( Vec3 a );
Vec3 normalised( Vec3 a );

/// A rigid motion p -> r p + t, built from URDF's origin: rpy about the fixed axes x, y, z, in this order.
struct Pose
{
	double r[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	Vec3 t;
};

Pose at( double x, double y, double z, double roll = 0, double pitch = 0, double yaw = 0 );
Pose operator*( const Pose& a, const Pose& b );
Vec3 operator*( const Pose& a, Vec3 p );
std::array<double, 4> quaternion( const Pose& pose ); ///< x, y, z, w
/// Rotation by `angle` about the unit axis.
Pose turned( Vec3 axis, double angle );

/// Triangles, counter-clockwise seen from outside.
struct Mesh
{
	std::vector<Vec3> vertices;
	std::vector<std::array<uint32_t, 3>> triangles;

	Mesh& add( const Mesh& other, const Pose& pose = {} );
	Mesh placed( const Pose& pose ) const;
	Mesh mirroredY() const; ///< y -> -y, winding turned
};

/// One cross-section of a loft: a superellipse in a plane z = const. Exponent 2 is an ellipse, 4 and above a rounded
/// rectangle.
struct Ring
{
	double z, rx, ry;
	double cx = 0, cy = 0;
	double exponent = 2;
};

/// Skin over the rings, in order; ends with zero radius become poles, others flat caps (or stay open). Rings may run back
/// (hollow bodies): a path that goes up on the outside and down on the inside is a vessel.
Mesh loft( const std::vector<Ring>& rings, int segments, bool caps = true );
/// Catmull-Rom rings in between, `steps` per span: organic shapes from a few key sections.
std::vector<Ring> smoothed( const std::vector<Ring>& keys, int steps );
/// Adds elliptic domes of the given heights to both ends (0: leaves that end flat).
std::vector<Ring> domed( std::vector<Ring> rings, double bottom, double top, int steps );

/// A body of revolution about z from (radius, z) points, in loft order.
Mesh lathe( const std::vector<std::array<double, 2>>& profile, int segments, bool caps = true );
/// The same with Catmull-Rom points in between.
std::vector<std::array<double, 2>> smoothedProfile( const std::vector<std::array<double, 2>>& keys, int steps );

Mesh box( Vec3 size ); ///< centred, 12 triangles
/// Centred box with rounded edges, `steps` facets per quarter turn.
Mesh roundedBox( Vec3 size, double radius, int steps );
/// Centred box with chamfered edges, 44 triangles.
Mesh chamferedBox( Vec3 size, double chamfer );
/// A box given by its corners: chamfered, or with `steps` > 0 rounded.
Mesh board( Vec3 low, Vec3 high, double bevel = 0.003, int steps = 0 );
Mesh sphere( double radius, int segments, int rings );
/// Cylinder along z from z0 to z1 with bevelled rims.
Mesh drum( double radius, double z0, double z1, double bevel, int segments );
/// Pipe along a polyline, with flat ends, or closed to a loop.
Mesh tube( const std::vector<Vec3>& path, double radius, int segments, bool closed = false );
/// The polyline with its inner corners replaced by arcs that begin `fillet` before the corner.
std::vector<Vec3> rounded( const std::vector<Vec3>& path, double fillet, int steps );
/// Points of a circle about z in the plane z.
std::vector<Vec3> circle( double radius, double z, int points );

/// Binary STL, and Wavefront OBJ: the bytes of the file.
std::string toStl( const Mesh& mesh );
std::string toObj( const Mesh& mesh );

} // namespace kitchen
