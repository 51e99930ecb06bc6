// SPDX-License-Identifier: BSD-3-Clause
// Vectors, poses, and shapes as the certificate has them: convex elements in an order in which halves of index ranges are compact.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace leeway::certify
{

using Vec = std::array<double, 3>;

inline Vec operator+( const Vec& a, const Vec& b )
{
	return { a[0] + b[0], a[1] + b[1], a[2] + b[2] };
}
inline Vec operator-( const Vec& a, const Vec& b )
{
	return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}
inline Vec operator*( double s, const Vec& a )
{
	return { s * a[0], s * a[1], s * a[2] };
}
inline double dot( const Vec& a, const Vec& b )
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vec cross( const Vec& a, const Vec& b )
{
	return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}
inline double length( const Vec& a )
{
	return std::sqrt( dot( a, a ) );
}

/// A rotation by columns, and a shift.
struct Pose
{
	std::array<Vec, 3> columns{ Vec{ 1, 0, 0 }, Vec{ 0, 1, 0 }, Vec{ 0, 0, 1 } };
	Vec shift{ 0, 0, 0 };
	Vec turned( const Vec& v ) const { return v[0] * columns[0] + ( v[1] * columns[1] + v[2] * columns[2] ); }
	Vec turnedBack( const Vec& v ) const { return { dot( columns[0], v ), dot( columns[1], v ), dot( columns[2], v ) }; }
	Vec placed( const Vec& v ) const { return turned( v ) + shift; }
};
Pose operator*( const Pose& a, const Pose& b );

/// As stored: x, y, z and a quaternion x, y, z, w, normalised by readers.
using StoredPose = std::array<double, 7>;
Pose poseOf( const StoredPose& stored );

/// Values are those of the file.
enum class Kind : std::uint8_t
{
	triangles = 1,
	balls = 2,
	boxes = 3,
	cylinder = 4,
	capsule = 5,
	cone = 6,
	halfspace = 7,
	plane = 8
};

/// Elements [begin, end) of a shape: their box and a sphere around them.
struct Range
{
	std::uint32_t begin = 0, end = 0;
	Vec middle{}, half{};
	double radius = 0;
};

struct Shape
{
	std::string source;
	Kind kind = Kind::triangles;
	bool solid = false; ///< triangles: their inside counts too, so they are not divided
	double radius = 0;  ///< of triangles; cylinder, capsule, cone
	double height = 0;
	std::vector<double> numbers;        ///< triangles: vertices; balls: x, y, z, radius; boxes: least and greatest corner
	std::vector<std::uint32_t> corners; ///< of triangles
	std::vector<Range> ranges;          ///< ranges[0] is all; the halves of ranges[i] are i + 1 and right( i )

	bool unbounded() const { return kind == Kind::halfspace || kind == Kind::plane; }
	std::uint32_t count() const;
	std::size_t right( std::size_t range ) const;
	bool divisible( std::size_t range ) const { return !solid && ranges[range].end - ranges[range].begin > 1; }
	/// Puts elements into an order whose halves are compact; before finish().
	void arrange();
	/// Computes `ranges`.
	void finish();
	/// The greatest height of the range's points in a direction of any length, shape frame.
	double support( std::size_t range, const Vec& direction, Vec* point = nullptr ) const;

private:
	double elementSupport( std::uint32_t element, const Vec& direction, double size, Vec* point ) const;
	void elementBox( std::uint32_t element, Vec& least, Vec& most ) const;
	double elementRadius( std::uint32_t element, const Vec& from ) const;
	double cornerSupport( const Range& range, const Vec& direction, double best, Vec* point ) const;
	Vec corner( std::uint32_t element, unsigned i ) const;

	std::vector<double> m_x, m_y, m_z; ///< of all corners, once finished
};

} // namespace leeway::certify
