// SPDX-License-Identifier: BSD-3-Clause
// The kinematic tree of an MJCF model: bodies with their joints and geoms; frames and replicas are resolved.
#pragma once

#include "mjcf/settings.hpp"

namespace leeway::io::detail::mjcf
{

struct Joint
{
	enum Type
	{
		HINGE,
		SLIDE,
		BALL,
		FREE
	};
	std::string name;
	const XMLElement* element = nullptr;
	Type type = HINGE;
	double position[3] = { 0, 0, 0 }; ///< of the anchor, in the body's frame
	double axis[3] = { 0, 0, 1 };     ///< unit length, in the body's frame
	bool limited = false;
	double lower = 0, upper = 0; ///< radians, metres
	double reference = 0;        ///< the value at which the body is where its element says

	std::size_t valueCount() const { return type == FREE ? 7 : type == BALL ? 4 : 1; } ///< in qpos
};

enum class GeomType
{
	PLANE,
	HFIELD,
	SPHERE,
	CAPSULE,
	ELLIPSOID,
	CYLINDER,
	BOX,
	MESH
};

struct Geom
{
	std::string name; ///< may be empty
	const XMLElement* element = nullptr;
	GeomType type = GeomType::SPHERE;
	std::string asset; ///< of a mesh or height field
	double size[3] = { 0, 0, 0 };
	lw_transform pose; ///< in the body's frame
	std::uint32_t contype = 1, conaffinity = 1;
	double margin = 0;
	std::optional<Colour> colour; ///< for pictures

	bool collides() const { return contype != 0 || conaffinity != 0; }
	bool meets( const Geom& other ) const
	{
		return ( contype & other.conaffinity ) != 0 || ( other.contype & conaffinity ) != 0;
	}
};

/// Colours of geoms, for pictures.
class Colours
{
public:
	Colours( const Document& document, const Defaults& defaults );
	/// rgba of its own or of its class, else that of its material. None for a texture, and for values that are no colour.
	/// @throws Error (no such class)
	std::optional<Colour> of( const XMLElement& geom, const std::string& child_class ) const;

private:
	const Defaults& m_defaults;
	std::map<std::string, const XMLElement*> m_materials;
};

struct Body
{
	std::string name;
	const XMLElement* element = nullptr;
	std::size_t parent = 0; ///< index; that of the world is its own
	lw_transform pose;      ///< in the parent's frame, at the reference values of its joints
	std::vector<Joint> joints;
	std::vector<Geom> geoms;
	std::size_t weld = 0; ///< the topmost body that it stands still against; 0 = fixed to the world
	bool mocap = false;
};

struct Tree
{
	std::vector<Body> bodies; ///< depth first, in the order of the file; the first is the world
};

/// @throws Error that names the element
Tree readTree( const Document& document, const Compiler& compiler, const Defaults& defaults, std::vector<Notice>& notices );

} // namespace leeway::io::detail::mjcf
