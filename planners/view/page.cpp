// SPDX-License-Identifier: BSD-3-Clause
#include "view/page.hpp"

#include <fmt/format.h>

extern const char* const leeway_page; // written by page/build.mjs; empty where the tools for it were absent

namespace leeway::view
{
namespace
{

const char* const mark = "<!--leeway-data-->";

/// A data block: never executed, and free of `<` inside.
std::string block( const std::string& id, const std::string& type, const std::string& content )
{
	return "<script type=\"" + type + "\" id=\"" + id + "\">" + content + "</script>\n";
}

std::string packed( const std::string& id, const std::string& bytes )
{
	return block( id, "text/plain", bytes.empty() ? "" : base64( gzip( bytes ) ) );
}

} // namespace

std::string viewProblem()
{
	return *leeway_page != '\0'
	           ? ""
	           : "this build of leeway has no page: its tools (npm, three.js, esbuild) were absent when it was configured";
}

void requireView( const std::string& option )
{
	if ( const std::string problem = viewProblem(); !problem.empty() )
	{
		throw io::Error(
		    "command line", option, problem, "build leeway with -DLEEWAY_BUILD_VIEW=ON, which says what is missing" );
	}
}

std::string pageHtml( const std::vector<const PageInput*>& chapters )
{
	requireView( "view" );
	Json names = Json::array();
	for ( const PageInput* chapter : chapters )
	{
		names.push_back( chapter->chapter );
	}
	std::string blocks;
	for ( std::size_t i = 0; i < chapters.size(); ++i )
	{
		PageContent content = pageContent( *chapters[i] );
		content.json["chapters"] = names;
		const std::string numbers(
		    reinterpret_cast<const char*>( content.numbers.data() ), content.numbers.size() * sizeof( double ) );
		const std::string of = i == 0 ? "" : fmt::format( "-{}", i ); // as page/data.js names them
		blocks += block( "model" + of, "application/json", jsonForScript( content.json ) ) +
		          packed( "bytes" + of, content.bytes.all() ) + packed( "numbers" + of, numbers ) +
		          packed( "blob" + of, content.blob );
	}
	const std::string html = leeway_page;
	const std::size_t at = html.find( mark );
	return html.substr( 0, at ) + blocks + html.substr( at + std::string( mark ).size() );
}

} // namespace leeway::view
