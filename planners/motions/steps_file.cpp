// SPDX-License-Identifier: BSD-3-Clause
// Files of steps: see steps_file.hpp.
#include "leeway/motions/steps_file.hpp"

#include "leeway/io/model.hpp"
#include "motions/yaml_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace leeway::motions
{
namespace
{

constexpr const char* remedy =
    "write trajectory: FILE, attach: OBJECT with link: LINK, release: OBJECT, allow: [LINK, OBJECT] or forbid: [LINK, OBJECT]";

std::string textOf( const std::string& file, const YAML::Node& node, const std::string& element )
{
	if ( !node.IsDefined() || !node.IsScalar() || node.Scalar().empty() )
	{
		throw io::Error( file, element, "is missing or no name", remedy );
	}
	return node.Scalar();
}

Step readStep( const std::string& file, const std::string& element, const YAML::Node& node )
{
	const std::vector<std::pair<std::string, Step::Kind>> kinds = { { "trajectory", Step::Kind::trajectory },
	    { "attach", Step::Kind::attach }, { "release", Step::Kind::release }, { "allow", Step::Kind::allow },
	    { "forbid", Step::Kind::forbid } };
	Step step;
	step.element = element;
	std::string key;
	for ( const auto& [name, kind] : kinds )
	{
		if ( child( node, name.c_str() ).IsDefined() )
		{
			if ( !key.empty() )
			{
				throw io::Error( file, element, fmt::format( "has both {} and {}", key, name ), "make two steps of them" );
			}
			key = name;
			step.kind = kind;
		}
	}
	if ( key.empty() )
	{
		throw io::Error( file, element, "is no step", remedy );
	}
	for ( const auto& entry : node )
	{
		const std::string name = entry.first.Scalar();
		const bool of_attach = step.kind == Step::Kind::attach && ( name == "link" || name == "touch_links" );
		if ( name != key && !of_attach )
		{
			throw io::Error( file, element + "." + name, "is unknown in a step with " + key, remedy );
		}
	}
	const YAML::Node value = child( node, key.c_str() );
	const std::string at = element + "." + key;
	if ( step.kind == Step::Kind::allow || step.kind == Step::Kind::forbid )
	{
		const std::vector<std::string> names = nameList( file, value, at );
		if ( names.size() != 2 )
		{
			throw io::Error( file, at, "is no pair", "name a link, or an attached object, and an object" );
		}
		step.link = names[0];
		step.object = names[1];
		return step;
	}
	( step.kind == Step::Kind::trajectory ? step.file : step.object ) = textOf( file, value, at );
	if ( step.kind == Step::Kind::trajectory && !std::filesystem::path( step.file ).is_absolute() )
	{
		step.file = ( std::filesystem::path( file ).parent_path() / step.file ).string();
	}
	std::error_code error;
	const std::filesystem::file_status found = std::filesystem::status( step.file, error );
	if ( step.kind == Step::Kind::trajectory && std::filesystem::exists( found ) &&
	     !std::filesystem::is_regular_file( found ) )
	{
		// Only options name streams of the program
		throw io::Error( file, at, fmt::format( "{} is not a file", step.file ), "name a file" );
	}
	if ( step.kind == Step::Kind::attach )
	{
		step.link = textOf( file, child( node, "link" ), element + ".link" );
		const YAML::Node touch = child( node, "touch_links" );
		step.touch_links =
		    touch.IsDefined() ? nameList( file, touch, element + ".touch_links" ) : std::vector<std::string>();
	}
	return step;
}

} // namespace

std::vector<Step> readSteps( const std::string& file )
{
	std::size_t bytes = 0;
	const std::vector<YAML::Node> documents = loadYaml( file, &bytes );
	const YAML::Node list = documents.size() == 1 ? child( documents.front(), "steps" ) : YAML::Node();
	if ( !list.IsDefined() || !list.IsSequence() )
	{
		throw io::Error( file, "steps", "is missing or no list", "write a list steps; " + std::string( remedy ) );
	}
	for ( const auto& entry : documents.front() )
	{
		if ( entry.first.Scalar() != "steps" )
		{
			throw io::Error( file, entry.first.Scalar(), "is unknown beside steps", remedy );
		}
	}
	std::vector<Step> steps;
	for ( std::size_t i = 0; i < list.size(); ++i )
	{
		steps.push_back( readStep( file, fmt::format( "steps[{}]", i ), list[i] ) );
	}
	if ( std::none_of( steps.begin(), steps.end(), []( const Step& step ) { return step.kind == Step::Kind::trajectory; } ) )
	{
		throw io::Error( file, "steps", "has no trajectory", "add a step with trajectory: FILE" );
	}
	return steps;
}

} // namespace leeway::motions
