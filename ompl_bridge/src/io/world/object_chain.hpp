// SPDX-License-Identifier: BSD-3-Clause
// The motion of an object as joints: the least chain that follows it exactly.
//
// World from object: a shift, the first orientation, and one rotation for each line (axis and a point on it) that the object turns about. A line is
// given in the object's frame at the moment when it first turns; a later piece whose line is where an earlier one is by then uses that joint
// again. Shifts are offsets from the first position along the axes of the world, so that all joints are 0 at the first pose.
#pragma once

#include "leeway/io/world_model.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace leeway::io::detail
{

using Vector3 = std::array<double, 3>;

/// A turn about a line of the world.
struct LineTurn
{
	Vector3 axis;  ///< unit
	Vector3 point; ///< on the line
	double angle;  ///< radians
};

class ObjectChain
{
public:
	explicit ObjectChain( const lw_transform& pose ) : m_first( pose ) {}

	/// The pose after all pieces so far.
	lw_transform pose() const;
	/// Appends a piece. @param shifts [degree + 1] control points of the shift from where the object is, the first is 0
	/// @param turn at a constant rate, in addition
	void add( double start, double end, const std::vector<Vector3>& shifts, const std::optional<LineTurn>& turn );

	/// Lines that it turns about, so far.
	std::size_t lineCount() const { return m_lines.size(); }
	/// How the last pose differs from the first.
	struct Gap
	{
		double distance = 0, angle = 0;
		bool joints = false; ///< the poses are equal, and the joints are not, even up to whole turns
	};
	Gap gap() const;
	/// Makes a loop of it, whose gap() is within `closing`: the last values become the first ones, up to whole turns.
	void close( double period );

	/// Appends links and joints below `root` to the model, and tells variables, limits and pieces to the part.
	/// @param part has a name; its spread_speed > 0 needs a joint that shifts
	void build( const std::string& root, const std::vector<PlacedShape>& shapes, WorldPart& part, RobotModel& model ) const;

	static constexpr double closing = 1e-6; ///< metres and radians

private:
	/// A line in the object's frame before its joint turns.
	struct Line
	{
		Vector3 axis, point;
	};
	struct Piece
	{
		double start, end;
		std::vector<std::vector<double>> rows; ///< [degree + 1][3 shifts, then angles of the lines known by then]
	};
	/// The end of a chain that is being built.
	struct Tail
	{
		WorldPart& part;
		RobotModel& model;
		std::string parent;              ///< the last link
		lw_transform to_joint;           ///< from it to the next joint
		std::vector<std::size_t> values; ///< of m_values, that have joints so far
	};
	std::pair<double, double> rangeOf( std::size_t value ) const;
	void append( Tail& tail, const std::string& name, lw_joint_type type, const Vector3& axis, std::size_t value ) const;
	void tell( const std::vector<std::size_t>& values, WorldPart& part ) const;
	/// From the object's frame after a line's joint to its frame before it.
	lw_transform turned( std::size_t j ) const;
	/// The line's joint, found or new, and -1 if that turns the other way around, else 1.
	std::pair<std::size_t, double> jointOf( const Line& line );

	lw_transform m_first;
	std::vector<Line> m_lines;
	std::vector<double> m_values = { 0, 0, 0 }; ///< shifts, then angles
	std::vector<double> m_advance;              ///< of a loop
	double m_period = 0;
	std::vector<Piece> m_pieces;
};

/// The turn about the position of `from` that makes its orientation that of `to`, the shorter way around; nothing if they are equal.
std::optional<LineTurn> turnBetween( const lw_transform& from, const lw_transform& to );

} // namespace leeway::io::detail
