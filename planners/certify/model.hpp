// SPDX-License-Identifier: BSD-3-Clause
// Robot, scene and question of a certificate as plain numbers; FORMAT.md has the meaning of each field.
#pragma once

#include "certify/geometry.hpp"
#include "leeway/certify/certificate.hpp"

#include <array>
#include <string>
#include <vector>

namespace leeway::certify
{

constexpr std::uint32_t nothing = 0xffffffffU;

/// A link and the joint above it. Links are listed after their parents; the first is the root.
struct Link
{
	enum Type : std::uint8_t
	{
		fixed = 0,
		turn = 1,
		shift = 2
	};
	std::string name, joint;
	std::uint32_t parent = 0;
	StoredPose origin{ 0, 0, 0, 0, 0, 0, 1 };
	Type type = fixed;
	Vec axis{ 0, 0, 1 };              ///< unit vector
	std::uint32_t variable = nothing; ///< value = multiplier * variable + offset; without one: offset
	double multiplier = 0, offset = 0;
};

struct Variable
{
	std::string name;
	double lower, upper;
};

/// A shape on a link, or of an object.
struct Placed
{
	std::uint32_t owner, shape;
	StoredPose pose;
};

struct Allowed
{
	bool object; ///< b is an object, else a link
	std::uint32_t a, b;
	std::string reason;
};

struct Margin
{
	bool object;
	std::uint32_t a, b;
	double value;
};

/// The common part of all motions of a robot in a scene.
struct Model
{
	unsigned claims = 3; ///< lw_check_flags
	std::vector<Link> links;
	std::vector<Variable> variables;
	std::vector<Shape> shapes;
	std::vector<Placed> bodies;
	std::vector<std::string> objects;
	std::vector<Placed> obstacles;
	std::vector<Allowed> allowed;
	std::vector<Margin> margins;
};

/// Two bodies, or a body and an obstacle, in the certificate's order.
struct Pair
{
	std::uint32_t a, b;
	bool object;
	double margin;
	std::uint32_t ancestor; ///< the link from which both motions are seen
	bool moves;             ///< variables of the group change the relative pose
	bool late = false;      ///< those of several tracks
};

/// How far variables may be from a piece of the motion, beside its own curve.
struct Tubes
{
	std::vector<double> timely; ///< [variables] tolerance and spread
	std::vector<double> late;   ///< [variables] more, between joints of several tracks: lag
};

/// @param state [group variables] of the motion: the values of quaternions, which rest
Model modelOf( const io::Problem& problem, const io::RobotModel& robot, const double* state, lw_check_flags flags,
    const std::string& file );

/// All pairs that must be proved, in the order of the certificate.
std::vector<Pair> pairsOf( const Model& model );

/// SHA-256 (FIPS 180-4) of bytes that come one after the other.
class Digest
{
public:
	void add( const char* bytes, std::size_t size );
	/// Of all bytes so far.
	std::array<std::uint8_t, 32> value() const;

private:
	void block( const std::uint8_t* bytes );

	std::array<std::uint32_t, 8> m_state = first();
	static std::array<std::uint32_t, 8> first();
	std::array<std::uint8_t, 64> m_rest{};
	std::uint64_t m_size = 0;
};

} // namespace leeway::certify
