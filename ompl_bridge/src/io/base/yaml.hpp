// SPDX-License-Identifier: BSD-3-Clause
// YAML of MoveIt messages: nodes that know where they are, strict numbers, both spellings of vectors and poses.
#pragma once

#include "base/io_internal.hpp"

#include <initializer_list>
#include <memory>

#include <yaml-cpp/yaml.h>

namespace leeway::io::detail
{

/// A node with its file and path ("world.collision_objects[2] Can1.primitives[0]"), so that every error can name it.
class YamlNode
{
public:
	YamlNode( const YamlNode& ) = default;
	YamlNode& operator=( const YamlNode& ) = delete; ///< assigning a YAML::Node changes the document

	/// The root of a file, which is a map. Duplicate keys anywhere are an error: one of them would be dropped. @throws Error
	static YamlNode load( const std::string& file, std::vector<Notice>& notices );
	/// @param content of the file @throws Error
	static YamlNode parse( const std::string& file, std::string content, std::vector<Notice>& notices );

	bool defined() const { return m_node.IsDefined() && !m_node.IsNull(); }
	bool isMap() const { return defined() && m_node.IsMap(); }
	bool isList() const { return defined() && m_node.IsSequence(); }
	bool isScalar() const { return defined() && m_node.IsScalar(); }
	/// Entries of a list; 0 if undefined or null. @throws Error if it is anything else
	std::size_t size() const;

	/// The value of a key; undefined if the map has none or this is undefined. @throws Error if this is not a map
	YamlNode operator[]( const char* key ) const;
	YamlNode operator[]( std::size_t index ) const;
	/// The first of these keys that is there.
	YamlNode firstOf( std::initializer_list<const char*> keys ) const;
	/// The same node with a name in its path.
	YamlNode named( const std::string& name ) const;

	[[noreturn]] void fail( const std::string& problem, const std::string& remedy ) const;
	void notice( const std::string& text ) const;
	std::string place() const; ///< path and line
	const std::string& file() const { return *m_file; }

	/// @throws Error for a key that is not in the list. For elements of our own: an unknown key there is a misspelt one, and
	/// ignoring it would lose a setting.
	void refuseUnknownKeys( const std::vector<std::string>& known ) const;
	/// @throws Error for a key that differs from one in the list by one letter, by case, or by '_' or '-' between words:
	/// collision_object would be a world without objects
	void refuseMisspelt( const std::string& key, const std::vector<std::string>& known ) const;
	/// A notice for every key that is not in the list. @throws Error for a misspelt one, and for one that begins with
	/// leeway_
	void noticeUnknownKeys( const std::vector<std::string>& known ) const;

	/// One notice for those of these keys that hold something else than zeros, empty texts and empty lists.
	void noticeUnused( const std::vector<std::string>& keys, const std::string& why ) const;

	/// @throws Error for the first of these keys that holds something else than those
	void refuseUsed( const std::vector<std::string>& keys, const std::string& problem, const std::string& remedy ) const;

	double number() const;    ///< a finite number
	std::string text() const; ///< a scalar
	std::string textOr( const char* fallback ) const;
	bool boolean() const;                   ///< true, false, 1, 0
	std::vector<double> numberList() const; ///< finite numbers
	std::vector<std::string> textList() const;
	std::string bytes() const;                       ///< a list of numbers from -128 to 255, or !!binary; empty if undefined
	std::vector<std::string> keys() const;           ///< of a map; none of anything else
	std::map<std::string, double> numberMap() const; ///< {name: number, ...}; empty if undefined
	/// [a, b, c] or {x: a, y: b, z: c} with the given keys. @throws Error if one is missing or there are more
	std::vector<double> vector( std::initializer_list<const char*> keys ) const;
	/// A quaternion x, y, z, w of length 1: others are normalised with a notice, zero is an error.
	std::array<double, 4> quaternion() const;
	/// position and orientation, or translation and rotation; a missing one is zero. @throws Error if both are
	lw_transform pose() const;
	/// header.frame_id without a leading slash; empty if there is none
	std::string frame() const;

private:
	YamlNode() = default;
	YamlNode child( const YAML::Node& node, const std::string& path ) const;

	YAML::Node m_node;
	std::string m_path;
	std::shared_ptr<const std::string> m_file;
	std::vector<Notice>* m_notices = nullptr;
};

/// joint_state and multi_dof_joint_state of robot_state or start_state.
JointState readJointState( const YamlNode& state );

} // namespace leeway::io::detail
