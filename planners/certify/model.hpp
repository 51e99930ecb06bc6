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

struct Source
{
	std::string name;
	std::array<std::uint8_t, 32> digest;
};

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
	double lower, upper, tolerance;
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

struct Model
{
	double min_d = 0;
	unsigned claims = 3; ///< lw_check_flags
	std::vector<Source> sources;
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
};

/// @throws io::Error for a moving quaternion
Model modelOf( const io::Problem& problem, const io::RobotModel& robot, const std::vector<Piece>& pieces,
    const Settings& settings, const std::string& file );

/// All pairs that must be proved, in the order of the certificate.
std::vector<Pair> pairsOf( const Model& model );

/// SHA-256 (FIPS 180-4).
std::array<std::uint8_t, 32> sha256( const std::string& bytes );

} // namespace leeway::certify
