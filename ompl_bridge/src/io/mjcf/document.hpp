// SPDX-License-Identifier: BSD-3-Clause
// An MJCF model as one tree of elements: included files stand in the place of <include>.
#pragma once

#include "base/xml.hpp"

#include <memory>
#include <set>

namespace leeway::io::detail::mjcf
{

using tinyxml2::XMLElement;

/// Elements belong to it.
class Document
{
public:
	/// @param main whose root is <mujoco> @throws Error (its includes: missing, twice, nested too deeply)
	explicit Document( std::unique_ptr<XmlFile> main );

	const std::string& path() const { return m_main->path(); }
	const XMLElement& root() const { return m_main->root(); }
	/// Child elements, with those of included files. @param name nullptr: all
	std::vector<const XMLElement*> children( const XMLElement& parent, const char* name = nullptr ) const;
	/// Child elements of all sections of this name. @param name nullptr: all
	std::vector<const XMLElement*> inSections( const char* section, const char* name = nullptr ) const;

	[[noreturn]] void fail(
	    const XMLElement& at, const std::string& what, const std::string& problem, const std::string& remedy ) const;
	Notice notice( const XMLElement& at, const std::string& what, const std::string& text ) const;
	/// The file of an element, and its place there: for errors of shapes.
	ShapeLoader::Place place( const XMLElement& at, const std::string& what, const std::string& owner ) const;
	/// A non-empty attribute. @throws Error
	std::string text( const XMLElement& at, const std::string& what, const char* attribute ) const;
	/// The attribute, or "". @throws Error if it is not UTF-8
	std::string optionalText( const XMLElement& at, const std::string& what, const char* attribute ) const;
	/// `least` to `most` finite numbers in an attribute. @throws Error
	std::vector<double> numbers(
	    const XMLElement& at, const std::string& what, const char* attribute, std::size_t least, std::size_t most ) const;
	/// The attribute range: two numbers, which may be infinite. @throws Error
	std::vector<double> range( const XMLElement& at, const std::string& what ) const;
	/// One of `words`. @throws Error
	std::string word(
	    const XMLElement& at, const std::string& what, const char* attribute, const std::vector<std::string>& words ) const;
	/// A whole number in the range of 32-bit bit masks. @throws Error
	std::int64_t integer( const XMLElement& at, const std::string& what, const char* attribute ) const;

private:
	const XmlFile& fileOf( const XMLElement& at ) const;
	void include( const XMLElement& parent, std::size_t depth );
	void append( const XMLElement& parent, const char* name, std::vector<const XMLElement*>& out ) const;

	std::unique_ptr<XmlFile> m_main;
	std::map<const XMLElement*, std::unique_ptr<XmlFile>> m_included; ///< by the <include>
	std::map<const tinyxml2::XMLDocument*, const XmlFile*> m_files;
	std::set<std::string> m_paths;
};

} // namespace leeway::io::detail::mjcf
