// SPDX-License-Identifier: BSD-3-Clause
// The parts of the demo before they are written: materials, the robot's links and joints, the kitchen's meshes and objects.
#pragma once

#include "geometry.hpp"

#include <map>

namespace kitchen
{

struct Material
{
	const char* name;
	double red, green, blue; ///< sRGB, 0 to 1
	double alpha;
	double roughness, metallic;
};

/// Every colour of the demo.
const std::vector<Material>& materials();
/// @throws std::out_of_range for an unknown name: a slip in the model
const Material& material( const std::string& name );

/// A mesh file.
struct Part
{
	std::string file; ///< with ending, relative to the meshes folder
	Mesh mesh;
	std::string material;
};

struct Link
{
	std::string name;
	std::vector<Part> parts;
};

struct Joint
{
	std::string name, type, parent, child;
	Vec3 xyz, rpy;
	Vec3 axis;
	double lower = 0, upper = 0;
};

struct Group
{
	std::string name;
	std::vector<std::string> joints;
};

struct Robot
{
	std::vector<Link> links;
	std::vector<Joint> joints;
	std::vector<Group> groups;
	/// links that touch by construction, with the reason
	std::vector<std::array<std::string, 3>> allowed;

	size_t movableJoints() const;
	size_t triangles() const;
	const Group& group( const std::string& name ) const;
};

Robot makeRobot();

/// An instance of a mesh, or a solid box or cylinder.
struct Placed
{
	int part = -1;    ///< index into Room::parts, or -1: primitive
	std::string type; ///< "box" (x, y, z) or "cylinder" (height, radius)
	std::vector<double> dimensions;
	std::string material; ///< of a primitive
	Pose pose;
};

struct Object
{
	std::string id;
	std::vector<Placed> shapes;
};

struct Room
{
	std::vector<Part> parts; ///< distinct meshes
	std::vector<Object> objects;

	size_t triangles() const; ///< of all instances; primitives have none
};

Room makeRoom();

/// Where a hand is to be: the point before its palm, the way its fingers point and (if not zero) the way the palm looks.
struct HandTarget
{
	std::string side; ///< "left" or "right"
	Vec3 tcp, fingers, palm;
};

/// A motion to plan: from the parked robot, arms tucked unless said otherwise, to a pose of one group.
struct Reach
{
	std::string name, group, what;
	std::map<std::string, double> start; ///< joints that are not at the tucked pose
	std::vector<HandTarget> hands;
	std::vector<double> goal; ///< of the group's joints, in its order
};

/// The pose in which the robot drives: arms folded before the chest.
std::map<std::string, double> tuckedPose();
/// The robot's parking place and the targets of its reaches, without goals.
std::vector<Reach> reachTasks();
/// The goal that kitchen_reaches found for a task; empty if none is stored.
std::vector<double> storedGoal( const std::string& reach );
/// Tasks and goals.
std::vector<Reach> makeReaches();

} // namespace kitchen
