// SPDX-License-Identifier: BSD-3-Clause
// Reports as files: JSON that comes back, a page with the findings, scripts that gnuplot understands.
#include "report/report.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <unistd.h>

namespace
{

namespace fs = std::filesystem;

/// A folder of its own, gone at the end; with a space and a quote in its name.
class Folder
{
public:
	Folder() : m_path( fs::temp_directory_path() / ( "leeway report's " + std::to_string( ::getpid() ) ) )
	{
		fs::remove_all( m_path );
	}
	~Folder() { fs::remove_all( m_path ); }
	std::string operator/( const std::string& name ) const { return ( m_path / name ).string(); }
	std::string path() const { return m_path.string(); }

private:
	fs::path m_path;
};

std::string read( const std::string& file )
{
	std::ifstream in( file, std::ios::binary );
	return std::string( ( std::istreambuf_iterator<char>( in ) ), std::istreambuf_iterator<char>() );
}

Plot linePlot()
{
	Plot plot;
	plot.id = "lines";
	plot.title = "A \"title\" with µ, 'quotes' and a \\ in it";
	plot.caption = "a <caption>";
	plot.x = { "separation", "mm", true };
	plot.y = { "time", "us" };
	plot.y2 = { "distance", "mm" };
	plot.series = { { "first", { { 1, 2, 1.5, 2.5 }, { 0, 3 }, { 10, std::nan( "" ) }, { 100, 4 } }, Mark::LINES, false },
	    { "second", { { 1, 20 }, { 100, 40 } }, Mark::DASHES, true }, { "", { { 5, 3 } }, Mark::POINTS, false } };
	return plot;
}

Plot namePlot()
{
	Plot plot;
	plot.id = "names";
	plot.title = "At names";
	plot.y = { "ratio", "", true };
	plot.categories = { "one", "1 % of a \"second\" one" };
	plot.series = { { "bars", { { 0, 1, 0.9, 1.2 }, { 1, 2, 1.9, 2.2 } }, Mark::BARS, false },
	    { "points", { { 0, 3 }, { 1, 4 } }, Mark::POINTS, false },
	    { "", { { -0.6, 1 }, { 1.6, 1 } }, Mark::DASHES, false } };
	return plot;
}

Report example()
{
	Outcome outcome;
	outcome.name = "paper";
	outcome.title = "Title <b>";
	outcome.tables.push_back( { "t", "Table", "note", { { "what", "" }, { "time", "us", -1 } },
	    { { "a & b", Measure{ 3.14159, 3, 3.5, 9 } }, { "c", 12345.6 } } } );
	outcome.plots = { linePlot(), namePlot() };
	outcome.claims = { { "paper, figure 9a", "GREEDY > COMPACT", "12 % more", Verdict::PARTLY, "because" } };
	return { { { "commit", "abc" }, { "quick", true } }, { outcome } };
}

} // namespace

TEST( Report, FileOfAnotherKindIsReadAsOne )
{
	const Folder folder;
	fs::create_directories( folder.path() );
	std::ofstream( folder / "planning.json" ) << R"({"rows": [{"problems": "box"}], "provenance": {}})";
	std::ofstream( folder / "torn.json" ) << R"({"format": "leeway experiments 1", "prov)";
	for ( const char* name : { "planning.json", "torn.json", "missing.json" } )
	{
		try
		{
			readReport( folder / name );
			FAIL() << name;
		}
		catch ( const std::runtime_error& error )
		{
			EXPECT_EQ( std::string( error.what() ).rfind( folder / name, 0 ), 0u ) << error.what();
		}
	}
}

TEST( Report, KeptFileSaysSomethingElse )
{
	const Folder folder;
	fs::create_directories( folder.path() );
	const Report report = example(); // once: it tells the time
	writeJson( report, folder / "result.json" );
	const Report back = readReport( folder / "result.json" );
	EXPECT_EQ( toJson( back ).dump(), toJson( report ).dump() );
	EXPECT_THROW( writeJson( report, folder / "no/such/folder.json" ), std::runtime_error );
}

TEST( Report, PageLeavesSomethingOutOrTakesItForMarkup )
{
	const std::string page =
	    htmlPage( example(), { { "paper-lines", "<?xml version='1.0'?>\n<svg><g id='a'/><use href='#a'/></svg>" } } );
	for ( const char* text : { "Title &lt;b&gt;", "a &lt;caption&gt;", "GREEDY &gt; COMPACT", "a &amp; b", "12 % more",
	          "because", "partly", "3.14 <small>3 – 3.50</small>", "12346", "time [µs]", "<th>commit</th><td>abc</td>",
	          "At names", "<svg><g id='paper-lines-a'/><use href='#paper-lines-a'/></svg>" } )
	{
		EXPECT_NE( page.find( text ), std::string::npos ) << text;
	}
	EXPECT_EQ( page.find( "<?xml" ), std::string::npos );
	EXPECT_EQ( page.find( "http" ), std::string::npos ) << "the page needs nothing else";
}

TEST( Report, PicturesOfOnePageShareTheirIds )
{
	const std::string svg =
	    "<svg><circle id=\"dot\"/><use xlink:href='#dot'/><g clip-path=\"url(#clip)\"/><clipPath id='clip'/></svg>";
	EXPECT_EQ( embeddedSvg( svg, "p-" ), "<svg><circle id=\"p-dot\"/><use xlink:href='#p-dot'/><g "
	                                     "clip-path=\"url(#p-clip)\"/><clipPath id='p-clip'/></svg>" );
}

TEST( Report, LineIsDrawnAcrossAGap )
{
	const std::string script = gnuplotScript( linePlot(), Picture::SVG, "out.svg" );
	// 0 has no place on a logarithmic axis; a blank line interrupts
	EXPECT_NE( script.find( "1 2 1.5 2.5\n\n\n100 4 4 4\n" ), std::string::npos ) << script;
	EXPECT_NE( script.find( "set logscale x" ), std::string::npos );
	EXPECT_NE( script.find( "time [µs]" ), std::string::npos );
	EXPECT_NE( script.find( "axes x1y2" ), std::string::npos );
}

TEST( Report, PercentInALabelIsTakenForAFormat )
{
	Plot plot = namePlot();
	plot.y.log = false;
	plot.y.label = "a label that is too long to find room beside its axis, in one line";
	const std::string script = gnuplotScript( plot, Picture::PNG, "out.png" );
	EXPECT_NE( script.find( "1 %% of a" ), std::string::npos );
	EXPECT_NE( script.find( "\\n" ), std::string::npos ) << script;
	EXPECT_NE( script.find( "with boxes" ), std::string::npos );
	EXPECT_EQ( gnuplotScript( namePlot(), Picture::PNG, "out.png" ).find( "with boxes" ), std::string::npos )
	    << "a bar on a logarithmic axis";
}

TEST( Report, PlotIsNotUnderstoodByGnuplot )
{
	if ( std::system( "command -v gnuplot >/dev/null 2>&1" ) != 0 )
	{
		GTEST_SKIP() << "there is no gnuplot";
	}
	const Folder folder;
	Report report = example();
	Plot empty;
	empty.id = "empty";
	report.outcomes[0].plots.push_back( empty );
	testing::internal::CaptureStderr();
	writeReport( report, folder.path() );
	EXPECT_EQ( testing::internal::GetCapturedStderr(), "" ); // gnuplot warns there
	const std::string page = read( folder / "index.html" );
	for ( const char* name : { "paper-lines", "paper-names", "paper-empty" } )
	{
		EXPECT_GT( fs::file_size( folder / ( std::string( name ) + ".png" ) ), 1000u );
		EXPECT_NE( read( folder / ( std::string( name ) + ".svg" ) ).find( "<svg" ), std::string::npos );
	}
	EXPECT_NE( page.find( "<svg" ), std::string::npos );
	EXPECT_NE( page.find( "first" ), std::string::npos );
	EXPECT_TRUE( fs::exists( folder / "result.json" ) );
	EXPECT_FALSE( fs::exists( folder / "paper-lines.svg.gp" ) );
}
