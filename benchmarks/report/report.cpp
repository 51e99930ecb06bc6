// SPDX-License-Identifier: BSD-3-Clause
// Outcomes of experiments as files: see report.hpp.
#include "report/report.hpp"

#include "support/provenance.hpp"
#include "support/temporary_folder.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// --- JSON ------------------------------------------------------------------------------------------------------------

Json toJson( const Report& report )
{
	Json json = {
	    { "format", "leeway experiments 1" }, { "provenance", report.provenance }, { "experiments", Json::array() } };
	for ( const Outcome& outcome : report.outcomes )
	{
		json["experiments"].push_back( toJson( outcome ) );
	}
	return json;
}

namespace
{

/// Rows of `leeway-bench peers --json`: one table for each letter of their workloads.
Report reportFromRows( const Json& json )
{
	Outcome outcome;
	outcome.name = "peers";
	outcome.title = "leeway and every peer at the same work";
	for ( const Json& row : json.at( "rows" ) )
	{
		const std::string workload = row.at( "workload" );
		const std::string id( 1, static_cast<char>( std::tolower( static_cast<unsigned char>( workload.at( 0 ) ) ) ) );
		auto table =
		    std::find_if( outcome.tables.begin(), outcome.tables.end(), [&]( const Table& t ) { return t.id == id; } );
		if ( table == outcome.tables.end() )
		{
			outcome.tables.push_back( { id, "workloads " + id, "",
			    { { "workload", "", 0 }, { "library", "", 0 }, { "mean", "us", -1 }, { "answers", "", 0 } }, {} } );
			table = outcome.tables.end() - 1;
		}
		const double mean = row.at( "mean_us" );
		table->rows.push_back( { workload, row.at( "library" ).get<std::string>(),
		    Measure{ mean, mean, mean, row.at( "count" ) }, row.value( "answers_hash", "" ) } );
	}
	return { json.at( "provenance" ), { outcome } };
}

} // namespace

Report reportFromJson( const Json& json )
{
	if ( json.is_object() && json.contains( "rows" ) && json.contains( "provenance" ) )
	{
		return reportFromRows( json );
	}
	if ( !json.is_object() || json.value( "format", "" ) != "leeway experiments 1" )
	{
		throw std::runtime_error( "it is no result of leeway-bench (--json, --report)" );
	}
	Report report;
	report.provenance = json.at( "provenance" );
	for ( const Json& outcome : json.at( "experiments" ) )
	{
		report.outcomes.push_back( outcomeFromJson( outcome ) );
	}
	return report;
}

namespace
{

std::string readFile( const std::string& file )
{
	std::ifstream in( file, std::ios::binary );
	if ( !in )
	{
		throw std::runtime_error( file + ": cannot be read" );
	}
	return std::string( ( std::istreambuf_iterator<char>( in ) ), std::istreambuf_iterator<char>() );
}

/// One line for each row and series, so that files can be read and differ by lines.
void dump( std::ostream& out, const Json& json, int depth )
{
	const std::string inner( static_cast<std::size_t>( depth ) + 1, '\t' ), outer( static_cast<std::size_t>( depth ), '\t' );
	const bool open = json.is_structured() && depth < 6 && !json.empty() && json.dump().size() > 120;
	if ( !open )
	{
		out << json.dump();
		return;
	}
	out << ( json.is_object() ? "{\n" : "[\n" );
	std::size_t i = 0;
	for ( const auto& item : json.items() )
	{
		out << inner;
		if ( json.is_object() )
		{
			out << Json( item.key() ).dump() << ": ";
		}
		dump( out, item.value(), depth + 1 );
		out << ( ++i < json.size() ? ",\n" : "\n" );
	}
	out << outer << ( json.is_object() ? "}" : "]" );
}

} // namespace

void writeJson( const Report& report, const std::string& file )
{
	std::ostringstream out;
	dump( out, toJson( report ), 0 );
	writeFile( file, out.str() + "\n" );
}

Report readReport( const std::string& file )
{
	try
	{
		return reportFromJson( Json::parse( readFile( file ) ) );
	}
	catch ( const Json::exception& error )
	{
		throw std::runtime_error( file + ": " + error.what() );
	}
	catch ( const std::runtime_error& error )
	{
		const std::string text = error.what();
		throw std::runtime_error( text.rfind( file, 0 ) == 0 ? text : file + ": " + text );
	}
}

// --- the page --------------------------------------------------------------------------------------------------------

namespace
{

const char* const STYLE = R"(
body { font: 15px/1.45 system-ui, sans-serif; color: #1c1c1c; background: #fff; }
body { max-width: 1100px; margin: 0 auto; padding: 1.5em; }
h1 { font-size: 1.6em; } h2 { margin-top: 2.2em; border-bottom: 2px solid #ddd; } h3 { margin-top: 1.6em; }
table { border-collapse: collapse; margin: .8em 0; font-size: .88em; display: block; overflow-x: auto; }
th, td { border: 1px solid #ddd; padding: .25em .55em; text-align: left; vertical-align: top; }
th { background: #f3f3f3; } td.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
td small { color: #777; } figure { margin: 1.2em 0; } figure svg { width: 100%; height: auto; max-width: 860px; }
figcaption, .note { color: #555; font-size: .9em; } .verdict { font-weight: bold; white-space: nowrap; }
.holds { color: #0a6b3d; } .partly { color: #8a5a00; } .differs { color: #9a3412; }
.BROKEN { color: #fff; background: #b00020; } details > summary { cursor: pointer; color: #345; }
)";

std::string escaped( const std::string& text )
{
	std::string out;
	for ( const char c : text )
	{
		switch ( c )
		{
		case '&':
			out += "&amp;";
			break;
		case '<':
			out += "&lt;";
			break;
		case '>':
			out += "&gt;";
			break;
		case '"':
			out += "&quot;";
			break;
		default:
			out += c;
		}
	}
	return out;
}

/// Three digits, or all of a whole number.
std::string figure( double value )
{
	char text[32];
	const bool whole = value == std::floor( value ) && std::abs( value ) < 1e9;
	const double size = std::abs( value );
	std::snprintf( text, sizeof text,
	    whole || size >= 100 ? "%.0f"
	    : size >= 10         ? "%.1f"
	    : size >= 1          ? "%.2f"
	                         : "%.3g",
	    value );
	return text;
}

std::string cellOf( const Cell& cell )
{
	if ( const std::string* word = std::get_if<std::string>( &cell ) )
	{
		return "<td>" + escaped( *word ) + "</td>";
	}
	if ( const double* value = std::get_if<double>( &cell ) )
	{
		return "<td class=n>" + figure( *value ) + "</td>";
	}
	const Measure& m = std::get<Measure>( cell );
	return "<td class=n>" + figure( m.median ) + " <small>" + figure( m.lower ) + " – " + figure( m.upper ) +
	       "</small></td>";
}

void writeTable( std::ostream& out, const Table& table )
{
	out << "<details" << ( table.rows.size() <= 30 ? " open" : "" ) << "><summary>" << escaped( table.title ) << " ("
	    << table.rows.size() << " rows)</summary>\n<p class=note>" << escaped( table.note ) << "</p>\n<table><thead><tr>";
	for ( const Column& column : table.columns )
	{
		out << "<th>" << escaped( column.name );
		if ( !column.unit.empty() )
		{
			out << " [" << ( column.unit == "us" ? "µs" : escaped( column.unit ) ) << "]";
		}
		out << "</th>";
	}
	out << "</tr></thead><tbody>\n";
	for ( const std::vector<Cell>& row : table.rows )
	{
		out << "<tr>";
		for ( const Cell& cell : row )
		{
			out << cellOf( cell );
		}
		out << "</tr>\n";
	}
	out << "</tbody></table></details>\n";
}

void writeClaims( std::ostream& out, const std::vector<const Outcome*>& outcomes, bool named )
{
	if ( std::all_of( outcomes.begin(), outcomes.end(), []( const Outcome* outcome ) { return outcome->claims.empty(); } ) )
	{
		return;
	}
	out << "<table><thead><tr>" << ( named ? "<th>experiment</th>" : "" )
	    << "<th>source</th><th>what it says</th><th>what we see</th><th></th><th>what differs, and "
	       "why</th></tr></thead><tbody>\n";
	for ( const Outcome* outcome : outcomes )
	{
		for ( const Claim& claim : outcome->claims )
		{
			const std::string verdict = verdictName( claim.verdict );
			out << "<tr>"
			    << ( named ? "<td><a href=\"#" + escaped( outcome->name ) + "\">" + escaped( outcome->name ) + "</a></td>"
			               : "" )
			    << "<td>" << escaped( claim.source ) << "</td><td>" << escaped( claim.text ) << "</td><td>"
			    << escaped( claim.figure ) << "</td><td class=\"verdict " << verdict << "\">" << verdict << "</td><td>"
			    << escaped( claim.why ) << "</td></tr>\n";
		}
	}
	out << "</tbody></table>\n";
}

void writeProvenance( std::ostream& out, const Json& provenance )
{
	out << "<table><tbody>\n";
	for ( const auto& item : provenance.items() )
	{
		out << "<tr><th>" << escaped( item.key() ) << "</th><td>"
		    << escaped( item.value().is_string() ? item.value().get<std::string>() : item.value().dump() ) << "</td></tr>\n";
	}
	out << "</tbody></table>\n";
}

void writeOutcome( std::ostream& out, const Outcome& outcome, const std::map<std::string, std::string>& pictures )
{
	out << "<h2 id=\"" << escaped( outcome.name ) << "\">" << escaped( outcome.title ) << "</h2>\n<p>"
	    << escaped( outcome.about ) << "</p>\n";
	if ( outcome.seconds > 0 )
	{
		out << "<p class=note>" << figure( outcome.seconds ) << " s</p>\n";
	}
	writeClaims( out, { &outcome }, false );
	for ( const Plot& plot : outcome.plots )
	{
		const std::string name = outcome.name + "-" + plot.id;
		const auto found = pictures.find( name );
		out << "<figure id=\"" << escaped( name ) << "\">\n";
		if ( found != pictures.end() )
		{
			out << embeddedSvg( found->second, name + "-" ) << "\n";
		}
		out << "<figcaption><b>" << escaped( plot.title ) << ".</b> " << escaped( plot.caption )
		    << "</figcaption></figure>\n";
	}
	out << "<h3>Figures</h3>\n";
	for ( const Table& table : outcome.tables )
	{
		writeTable( out, table );
	}
	if ( !outcome.details.is_null() )
	{
		out << "<details><summary>Settings and data</summary><pre>" << escaped( outcome.details.dump( 1, '\t' ) )
		    << "</pre></details>\n";
	}
}

} // namespace

std::string htmlPage( const Report& report, const std::map<std::string, std::string>& pictures )
{
	std::ostringstream out;
	out << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" << escaped( report.title )
	    << "</title>\n<style>" << STYLE << "</style></head><body>\n<h1>" << escaped( report.title ) << "</h1>\n<p>"
	    << escaped( report.about ) << "</p>\n";
	std::vector<const Outcome*> all;
	for ( const Outcome& outcome : report.outcomes )
	{
		all.push_back( &outcome );
	}
	writeClaims( out, all, true );
	out << "<details open><summary>Where these figures come from</summary>\n";
	writeProvenance( out, report.provenance );
	out << "</details>\n";
	for ( const Outcome& outcome : report.outcomes )
	{
		writeOutcome( out, outcome, pictures );
	}
	out << "</body></html>\n";
	return out.str();
}

// --- a folder --------------------------------------------------------------------------------------------------------

namespace
{

void draw( const Plot& plot, Picture picture, const std::string& file )
{
	const std::string script = file + ".gp";
	writeFile( script, gnuplotScript( plot, picture, file ) );
	runGnuplot( script );
	fs::remove( script );
}

} // namespace

void writePage( const Report& report, const std::string& file )
{
	if ( !hasGnuplot() )
	{
		throw std::runtime_error(
		    file + ": there is no gnuplot to draw it; install it (Debian: apt-get install gnuplot-nox)" );
	}
	const TemporaryFolder folder;
	std::map<std::string, std::string> pictures;
	for ( const Outcome& outcome : report.outcomes )
	{
		for ( const Plot& plot : outcome.plots )
		{
			const std::string name = outcome.name + "-" + plot.id, picture = folder.path() / ( name + ".svg" );
			draw( plot, Picture::SVG, picture );
			pictures[name] = readFile( picture );
		}
	}
	writeFile( file, htmlPage( report, pictures ) );
}

void writeReport( const Report& report, const std::string& folder )
{
	fs::create_directories( folder );
	writeJson( report, folder + "/result.json" ); // the figures first: pictures can be drawn again
	if ( !hasGnuplot() )
	{
		throw std::runtime_error(
		    "there is no gnuplot; install it (Debian: apt-get install gnuplot-nox), then: leeway-bench report " + folder +
		    "/result.json " + folder );
	}
	std::map<std::string, std::string> pictures;
	for ( const Outcome& outcome : report.outcomes )
	{
		for ( const Plot& plot : outcome.plots )
		{
			const std::string name = outcome.name + "-" + plot.id, file = folder + "/" + name;
			draw( plot, Picture::SVG, file + ".svg" );
			draw( plot, Picture::PNG, file + ".png" );
			pictures[name] = readFile( file + ".svg" );
		}
	}
	writeFile( folder + "/index.html", htmlPage( report, pictures ) );
}
