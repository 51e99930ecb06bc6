// SPDX-License-Identifier: BSD-3-Clause
// Results of experiments, in numbers and in files: see experiment.hpp.
#include "report/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

using Json = nlohmann::ordered_json;

Measure measure( std::vector<double> values )
{
	if ( values.empty() )
	{
		return {};
	}
	std::sort( values.begin(), values.end() );
	return { quantile( values, 0.5 ), quantile( values, 0.25 ), quantile( values, 0.75 ), values.size() };
}

const char* verdictName( Verdict verdict )
{
	switch ( verdict )
	{
	case Verdict::HOLDS:
		return "holds";
	case Verdict::PARTLY:
		return "partly";
	case Verdict::DIFFERS:
		return "differs";
	case Verdict::BROKEN:
		break;
	}
	return "BROKEN";
}

bool promisesKept( const Outcome& outcome )
{
	return std::none_of( outcome.claims.begin(), outcome.claims.end(),
	    []( const Claim& claim ) { return claim.verdict == Verdict::BROKEN; } );
}

// --- to JSON ---------------------------------------------------------------------------------------------------------

namespace
{

/// Six digits: no figure here is better, and files stay small. JSON cannot express NaN and infinities; we use three words.
Json number( double value )
{
	if ( !std::isfinite( value ) )
	{
		return Json{ { "number", std::isnan( value ) ? "nan" : value > 0 ? "inf" : "-inf" } };
	}
	char text[32];
	std::snprintf( text, sizeof text, "%.6g", value );
	const double rounded = std::strtod( text, nullptr );
	// counts without a ".0" behind them
	return std::abs( rounded ) < 1e6 && rounded == std::floor( rounded ) ? Json( static_cast<std::int64_t>( rounded ) )
	                                                                     : Json( rounded );
}

Json cell( const Cell& value )
{
	if ( const std::string* word = std::get_if<std::string>( &value ) )
	{
		return *word;
	}
	if ( const double* figure = std::get_if<double>( &value ) )
	{
		return number( *figure );
	}
	const Measure& m = std::get<Measure>( value );
	return Json::array( { number( m.median ), number( m.lower ), number( m.upper ), m.count } );
}

Json toJson( const Table& table )
{
	Json json = { { "id", table.id }, { "title", table.title }, { "note", table.note }, { "columns", Json::array() },
	    { "rows", Json::array() } };
	for ( const Column& column : table.columns )
	{
		json["columns"].push_back( { { "name", column.name }, { "unit", column.unit }, { "better", column.better } } );
	}
	for ( const std::vector<Cell>& row : table.rows )
	{
		if ( row.size() != table.columns.size() )
		{
			throw std::logic_error( "table " + table.id + ": a row is not as long as the columns" );
		}
		Json cells = Json::array();
		for ( const Cell& value : row )
		{
			cells.push_back( cell( value ) );
		}
		json["rows"].push_back( std::move( cells ) );
	}
	return json;
}

Json toJson( const Axis& axis )
{
	Json json = { { "label", axis.label }, { "unit", axis.unit }, { "log", axis.log } };
	if ( !std::isnan( axis.from ) )
	{
		json["from"] = number( axis.from );
	}
	if ( !std::isnan( axis.to ) )
	{
		json["to"] = number( axis.to );
	}
	if ( !std::isnan( axis.step ) )
	{
		json["step"] = number( axis.step );
	}
	return json;
}

const char* const MARKS[] = { "lines", "points", "dashes", "bars" };

Json toJson( const Series& series )
{
	Json points = Json::array();
	for ( const Point& p : series.points )
	{
		Json point = Json::array( { number( p.x ), number( p.y ) } );
		if ( !std::isnan( p.low ) )
		{
			point.push_back( number( p.low ) );
			point.push_back( number( p.high ) );
		}
		points.push_back( std::move( point ) );
	}
	return { { "name", series.name }, { "mark", MARKS[static_cast<int>( series.mark )] }, { "second", series.second },
	    { "points", std::move( points ) } };
}

Json toJson( const Plot& plot )
{
	Json json = { { "id", plot.id }, { "title", plot.title }, { "caption", plot.caption }, { "x", toJson( plot.x ) },
	    { "y", toJson( plot.y ) }, { "y2", toJson( plot.y2 ) }, { "series", Json::array() },
	    { "categories", plot.categories } };
	for ( const Series& series : plot.series )
	{
		json["series"].push_back( toJson( series ) );
	}
	return json;
}

} // namespace

Json toJson( const Outcome& outcome )
{
	Json json = { { "name", outcome.name }, { "title", outcome.title }, { "about", outcome.about },
	    { "seconds", number( outcome.seconds ) }, { "claims", Json::array() }, { "tables", Json::array() },
	    { "plots", Json::array() }, { "details", outcome.details } };
	for ( const Claim& claim : outcome.claims )
	{
		json["claims"].push_back( { { "source", claim.source }, { "text", claim.text }, { "figure", claim.figure },
		    { "verdict", verdictName( claim.verdict ) }, { "why", claim.why } } );
	}
	for ( const Table& table : outcome.tables )
	{
		json["tables"].push_back( toJson( table ) );
	}
	for ( const Plot& plot : outcome.plots )
	{
		json["plots"].push_back( toJson( plot ) );
	}
	return json;
}

// --- from JSON -------------------------------------------------------------------------------------------------------

namespace
{

double numberOf( const Json& json )
{
	if ( !json.is_object() )
	{
		return json.get<double>();
	}
	const std::string word = json.at( "number" );
	const double inf = std::numeric_limits<double>::infinity();
	return word == "inf" ? inf : word == "-inf" ? -inf : std::numeric_limits<double>::quiet_NaN();
}

Cell cellOf( const Json& json )
{
	if ( json.is_string() )
	{
		return json.get<std::string>();
	}
	if ( json.is_array() )
	{
		return Measure{
		    numberOf( json.at( 0 ) ), numberOf( json.at( 1 ) ), numberOf( json.at( 2 ) ), json.at( 3 ).get<std::size_t>() };
	}
	return numberOf( json );
}

Table tableOf( const Json& json )
{
	Table table{ json.at( "id" ), json.at( "title" ), json.at( "note" ), {}, {} };
	for ( const Json& column : json.at( "columns" ) )
	{
		table.columns.push_back( { column.at( "name" ), column.at( "unit" ), column.at( "better" ).get<int>() } );
	}
	for ( const Json& row : json.at( "rows" ) )
	{
		table.rows.emplace_back();
		for ( const Json& value : row )
		{
			table.rows.back().push_back( cellOf( value ) );
		}
		if ( table.rows.back().size() != table.columns.size() )
		{
			throw std::runtime_error( "table " + table.id + ": a row is not as long as the columns" );
		}
	}
	return table;
}

Axis axisOf( const Json& json )
{
	Axis axis;
	axis.label = json.at( "label" );
	axis.unit = json.at( "unit" );
	axis.log = json.at( "log" ).get<bool>();
	axis.from = json.contains( "from" ) ? numberOf( json["from"] ) : axis.from;
	axis.to = json.contains( "to" ) ? numberOf( json["to"] ) : axis.to;
	axis.step = json.contains( "step" ) ? numberOf( json["step"] ) : axis.step;
	return axis;
}

Series seriesOf( const Json& json )
{
	const std::string mark = json.at( "mark" );
	const auto known = std::find( std::begin( MARKS ), std::end( MARKS ), mark );
	if ( known == std::end( MARKS ) )
	{
		throw std::runtime_error( "series " + json.at( "name" ).get<std::string>() + ": unknown mark " + mark );
	}
	Series series{
	    json.at( "name" ), {}, static_cast<Mark>( known - std::begin( MARKS ) ), json.at( "second" ).get<bool>() };
	for ( const Json& values : json.at( "points" ) )
	{
		Point point;
		point.x = numberOf( values.at( 0 ) );
		point.y = numberOf( values.at( 1 ) );
		if ( values.size() > 2 )
		{
			point.low = numberOf( values.at( 2 ) );
			point.high = numberOf( values.at( 3 ) );
		}
		series.points.push_back( point );
	}
	return series;
}

Plot plotOf( const Json& json )
{
	Plot plot;
	plot.id = json.at( "id" );
	plot.title = json.at( "title" );
	plot.caption = json.at( "caption" );
	plot.x = axisOf( json.at( "x" ) );
	plot.y = axisOf( json.at( "y" ) );
	plot.y2 = axisOf( json.at( "y2" ) );
	plot.categories = json.at( "categories" ).get<std::vector<std::string>>();
	for ( const Json& series : json.at( "series" ) )
	{
		plot.series.push_back( seriesOf( series ) );
	}
	return plot;
}

Claim claimOf( const Json& json )
{
	Claim claim{ json.at( "source" ), json.at( "text" ), json.at( "figure" ), Verdict::HOLDS, json.at( "why" ) };
	const std::string verdict = json.at( "verdict" );
	for ( const Verdict known : { Verdict::HOLDS, Verdict::PARTLY, Verdict::DIFFERS, Verdict::BROKEN } )
	{
		if ( verdict == verdictName( known ) )
		{
			claim.verdict = known;
			return claim;
		}
	}
	throw std::runtime_error( "claim \"" + claim.text + "\": unknown verdict " + verdict );
}

} // namespace

Outcome outcomeFromJson( const Json& json )
{
	Outcome outcome;
	outcome.name = json.at( "name" );
	outcome.title = json.at( "title" );
	outcome.about = json.at( "about" );
	outcome.seconds = numberOf( json.at( "seconds" ) );
	outcome.details = json.at( "details" );
	for ( const Json& claim : json.at( "claims" ) )
	{
		outcome.claims.push_back( claimOf( claim ) );
	}
	for ( const Json& table : json.at( "tables" ) )
	{
		outcome.tables.push_back( tableOf( table ) );
	}
	for ( const Json& plot : json.at( "plots" ) )
	{
		outcome.plots.push_back( plotOf( plot ) );
	}
	return outcome;
}
