// SPDX-License-Identifier: BSD-3-Clause
#include "view/page.hpp"

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

std::string pageHtml( const PageInput& page )
{
	requireView( "view" );
	const PageContent content = pageContent( page );
	const std::string numbers(
	    reinterpret_cast<const char*>( content.numbers.data() ), content.numbers.size() * sizeof( double ) );
	const std::string html = leeway_page;
	const std::size_t at = html.find( mark );
	return html.substr( 0, at ) + block( "model", "application/json", jsonForScript( content.json ) ) +
	       packed( "bytes", content.bytes.all() ) + packed( "numbers", numbers ) + packed( "blob", content.blob ) +
	       html.substr( at + std::string( mark ).size() );
}

} // namespace leeway::view
