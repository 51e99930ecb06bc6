// SPDX-License-Identifier: BSD-3-Clause
// XML with strict numbers and errors that name file, element and line.
#pragma once

#include "base/io_internal.hpp"

#include <tinyxml2.h>

namespace leeway::io::detail
{

/// The child elements of one name (nullptr: of any), for a range-based for.
class Children
{
public:
	class Iterator
	{
	public:
		Iterator( const tinyxml2::XMLElement* element, const char* name ) : m_element( element ), m_name( name ) {}
		const tinyxml2::XMLElement& operator*() const { return *m_element; }
		Iterator& operator++()
		{
			m_element = m_element->NextSiblingElement( m_name );
			return *this;
		}
		bool operator!=( const Iterator& other ) const { return m_element != other.m_element; }

	private:
		const tinyxml2::XMLElement* m_element;
		const char* m_name;
	};

	Children( const tinyxml2::XMLElement& parent, const char* name ) : m_parent( parent ), m_name( name ) {}
	Iterator begin() const { return { m_parent.FirstChildElement( m_name ), m_name }; }
	Iterator end() const { return { nullptr, m_name }; }

private:
	const tinyxml2::XMLElement& m_parent;
	const char* m_name;
};

inline Children children( const tinyxml2::XMLElement& parent, const char* name )
{
	return { parent, name };
}

struct XmlProblem
{
	int line;
	std::string text;
};

/// Parses a whole document: one root element, and nothing beside it that tinyxml2 would silently accept or drop.
/// @return the first problem, if there is one
std::optional<XmlProblem> parseXml( tinyxml2::XMLDocument& document, std::string content );

/// @throws Error that names the remedy if the content is a stage of USD
void refuseUsd( const std::string& file, const std::string& content );

/// Whether the content can only be XML, well-formed or not, and no YAML.
bool beginsAsXml( const std::string& content );

/// An XML file.
class XmlFile
{
public:
	/// @throws Error as readWholeFile(), and for text that is no XML
	explicit XmlFile( const std::string& file ) : XmlFile( file, readWholeFile( file ) ) {}
	/// @param content of the file @throws Error
	XmlFile( const std::string& file, std::string content );
	/// The root is <robot>, and nothing is left for xacro. @param kind "URDF" or "SRDF", for messages
	/// @throws Error that names the format of the file, if it is a known one, and the remedy
	void requireRobot( const char* kind ) const;
	/// A <robot> that declares xacro's namespace and has something for xacro to replace.
	bool isXacro() const;

	const std::string& path() const { return m_path; }
	const tinyxml2::XMLElement& root() const { return *m_doc.RootElement(); }
	const tinyxml2::XMLDocument& document() const { return m_doc; }
	tinyxml2::XMLDocument& document() { return m_doc; }

	/// @param what, the element in words, e.g. "link forearm"; the line is added
	[[noreturn]] void fail( const tinyxml2::XMLElement& at, const std::string& what, const std::string& problem,
	    const std::string& remedy ) const;
	std::string place( const tinyxml2::XMLElement& at, const std::string& what ) const;

	/// A non-empty attribute. @throws Error, also if it is not UTF-8
	std::string text( const tinyxml2::XMLElement& at, const std::string& what, const char* attribute ) const;
	/// @throws Error if the attribute is there and is not UTF-8
	void requireUtf8( const tinyxml2::XMLElement& at, const std::string& what, const char* attribute ) const;
	/// `count` finite numbers in an attribute, separated by blanks (count 0: one or more). @throws Error
	std::vector<double> numbers(
	    const tinyxml2::XMLElement& at, const std::string& what, const char* attribute, std::size_t count ) const;

private:
	std::string m_path;
	tinyxml2::XMLDocument m_doc;
};

/// The SRDF that a model was loaded with, to be changed, or else an empty one of the model's name.
class SrdfDraft
{
public:
	/// @throws Error
	explicit SrdfDraft( const RobotModel& model );
	tinyxml2::XMLDocument& document() { return m_file ? m_file->document() : m_fresh; }

private:
	std::optional<XmlFile> m_file;
	tinyxml2::XMLDocument m_fresh;
};

/// The document as text, indented.
std::string printed( const tinyxml2::XMLDocument& document );

} // namespace leeway::io::detail
