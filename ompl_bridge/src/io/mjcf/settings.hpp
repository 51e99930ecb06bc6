// SPDX-License-Identifier: BSD-3-Clause
// Settings of a whole MJCF model: <compiler>, <option> and the classes of <default>.
#pragma once

#include "mjcf/document.hpp"

namespace leeway::io::detail::mjcf
{

/// Attributes of <compiler> and flags of <option> that change kinematics or contacts.
struct Compiler
{
	bool degrees = true;
	std::string euler = "xyz"; ///< lower case: about axes that turn with the frame; upper case: about fixed ones
	std::string mesh_folder;   ///< meshdir or assetdir; empty if none
	bool auto_limits = true, strip_path = false, align_free = false;
	bool filter_parent = true; ///< links and the links above them do not collide

	double angle( double value ) const { return degrees ? value * ( 3.14159265358979323846 / 180 ) : value; }
};

/// @throws Error
Compiler readCompiler( const Document& document, std::vector<Notice>& notices );

/// Attributes of the elements, their own and those of their class.
class Defaults
{
public:
	/// @throws Error (a class that is defined twice, or has no name)
	explicit Defaults( const Document& document );

	/// The element that has the attribute: the given one, or the one of its class; nullptr if there is none.
	/// @param child_class of the bodies and frames around it; empty if none
	/// @param kind its name in a class, if that is not its own @throws Error (no such class)
	const XMLElement* find(
	    const XMLElement& element, const std::string& child_class, const char* attribute, const char* kind = nullptr ) const;
	/// The same for the five ways to write an orientation: an element that has one uses none of its class.
	std::pair<const XMLElement*, const char*> findOrientation(
	    const XMLElement& element, const std::string& child_class ) const;
	/// @throws Error if the class of a body or frame is not defined
	void requireClass( const XMLElement& at, const std::string& what, const std::string& name ) const;

private:
	/// (element, attribute) -> the element that has it
	using Attributes = std::map<std::pair<std::string, std::string>, const XMLElement*>;

	void readClass( const XMLElement& element, Attributes& attributes, std::size_t depth );
	const Attributes& classOf( const XMLElement& element, const std::string& child_class ) const;

	const Document& m_document;
	std::map<std::string, Attributes> m_classes;
};

/// The orientation attributes; the first element that has one uses no other.
constexpr const char* orientations[] = { "quat", "axisangle", "euler", "xyaxes", "zaxis" };

/// The one that an element has; nullptr if none. @throws Error if it has two
const char* orientationOf( const Document& document, const XMLElement& element );

/// Poses of elements.
class Poses
{
public:
	Poses( const Document& document, const Compiler& compiler, const Defaults& defaults )
	    : m_document( document ), m_compiler( compiler ), m_defaults( defaults )
	{
	}
	/// pos and orientation of a body or frame: these have no default class. @throws Error
	lw_transform own( const XMLElement& element, const std::string& what ) const;
	/// pos and orientation of a geom. @throws Error
	lw_transform ofClass( const XMLElement& element, const std::string& what, const std::string& child_class ) const;
	/// A frame in the middle between the ends of fromto, z from the second to the first. @param length between the ends, metres
	lw_transform between( const XMLElement& carrier, const std::string& what, double& length ) const;
	/// Angles about the axes of `eulerseq`. @param euler three numbers
	lw_transform turn( const std::vector<double>& position, const std::vector<double>& euler ) const;

private:
	lw_transform read(
	    const XMLElement* position, const XMLElement* orientation, const char* kind, const std::string& what ) const;

	const Document& m_document;
	const Compiler& m_compiler;
	const Defaults& m_defaults;
};

/// From a position and a quaternion w, x, y, z as MJCF has it. @return false for a zero quaternion
bool fromQuaternion( const double position[3], const double wxyz[4], lw_transform& out );
/// A turn about a unit axis through the origin.
lw_transform aboutAxis( const double axis[3], double angle );
lw_transform shiftBy( double x, double y, double z );

} // namespace leeway::io::detail::mjcf
