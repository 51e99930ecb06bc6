// SPDX-License-Identifier: BSD-3-Clause
// Plots as gnuplot scripts: see report.hpp.
#include "report/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace
{

/// Okabe and Ito's colours: told apart by colour-blind readers too.
const char* const COLOURS[] = { "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#333333", "#8c6d1f" };

/// The text as it must stand inside double quotes of gnuplot.
std::string inside( const std::string& text )
{
	std::string out;
	for ( const char c : text )
	{
		out += c == '"' || c == '\\' ? std::string( "\\" ) + c : c == '\n' ? " " : std::string( 1, c );
	}
	return out;
}

std::string inQuotes( const std::string& text )
{
	return "\"" + inside( text ) + "\"";
}

/// In two lines where it would not fit beside the axis.
std::string labelOf( const Axis& axis )
{
	constexpr std::size_t FITS = 45;
	std::string text = axis.unit.empty() ? axis.label : axis.label + " [" + ( axis.unit == "us" ? "µs" : axis.unit ) + "]";
	const std::size_t space = text.size() > FITS ? text.rfind( ' ', text.size() / 2 ) : std::string::npos;
	return space == std::string::npos
	           ? inQuotes( text )
	           : "\"" + inside( text.substr( 0, space ) ) + "\\n" + inside( text.substr( space + 1 ) ) + "\"";
}

/// A label of an axis: gnuplot puts numbers where it finds a %.
std::string ticLabel( const std::string& text )
{
	std::string out;
	for ( const char c : text )
	{
		out += c == '%' ? std::string( "%%" ) : std::string( 1, c );
	}
	return inQuotes( out );
}

std::string number( double value )
{
	std::ostringstream out;
	out.precision( 9 );
	out << value;
	return out.str();
}

void setAxis( std::ostream& out, const char* name, const Axis& axis )
{
	out << "set " << name << "label " << labelOf( axis ) << "\n";
	if ( axis.log )
	{
		out << "set logscale " << name << "\n";
	}
	if ( !std::isnan( axis.from ) || !std::isnan( axis.to ) )
	{
		out << "set " << name << "range [" << ( std::isnan( axis.from ) ? "" : number( axis.from ) ) << ":"
		    << ( std::isnan( axis.to ) ? "" : number( axis.to ) ) << "]\n";
	}
	if ( !std::isnan( axis.step ) )
	{
		out << "set " << name << "tics " << number( axis.step ) << "\n";
	}
}

bool drawable( double value, const Axis& axis )
{
	return std::isfinite( value ) && ( !axis.log || value > 0 );
}

/// x, y, low, high; a blank line where the line is interrupted.
void writeData( std::ostream& out, const Plot& plot, std::size_t index )
{
	const Series& series = plot.series[index];
	const Axis& y = series.second ? plot.y2 : plot.y;
	out << "$s" << index << " << END\n";
	for ( const Point& p : series.points )
	{
		if ( !drawable( p.x, plot.x ) || !drawable( p.y, y ) )
		{
			out << "\n";
			continue;
		}
		const bool spread = drawable( p.low, y ) && drawable( p.high, y );
		out << number( p.x ) << ' ' << number( p.y ) << ' ' << number( spread ? p.low : p.y ) << ' '
		    << number( spread ? p.high : p.y ) << "\n";
	}
	out << "END\n";
}

bool hasSpread( const Series& series )
{
	for ( const Point& p : series.points )
	{
		if ( !std::isnan( p.low ) )
		{
			return true;
		}
	}
	return false;
}

bool usesSecond( const Plot& plot )
{
	for ( const Series& series : plot.series )
	{
		if ( series.second )
		{
			return true;
		}
	}
	return false;
}

/// A logarithmic axis of less than two decades has hardly a label of its own.
void setLogTics( std::ostream& out, const Plot& plot )
{
	double least = plot.y.from > 0 ? plot.y.from : std::numeric_limits<double>::infinity(), most = 0;
	for ( const Series& series : plot.series )
	{
		for ( const Point& p : series.points )
		{
			least = drawable( p.y, plot.y ) ? std::min( least, p.y ) : least;
			most = drawable( p.y, plot.y ) ? std::max( most, p.y ) : most;
		}
	}
	if ( !plot.y.log || !( most < 100 * least ) )
	{
		return;
	}
	out << "set ytics (";
	const char* separator = "";
	for ( double decade = std::pow( 10, std::floor( std::log10( least ) ) ); decade <= most; decade *= 10 )
	{
		for ( const double tic : { 1.0, 1.5, 2.0, 3.0, 5.0, 7.0 } )
		{
			out << separator << number( tic * decade );
			separator = ", ";
		}
	}
	out << ")\n";
}

/// Series side by side at names.
void plotCategories( std::ostream& out, const Plot& plot )
{
	std::size_t columns = 0, column = 0;
	for ( const Series& series : plot.series )
	{
		columns += series.mark == Mark::POINTS || series.mark == Mark::BARS;
	}
	const double width = 0.8 / static_cast<double>( std::max<std::size_t>( 1, columns ) );
	out << "set boxwidth " << width
	    << "\nset style fill solid 0.8 noborder\nset xrange [-0.6:" << static_cast<double>( plot.categories.size() ) - 0.4
	    << "]\nset xtics (";
	for ( std::size_t i = 0; i < plot.categories.size(); ++i )
	{
		out << ( i > 0 ? ", " : "" ) << ticLabel( plot.categories[i] ) << ' ' << i;
	}
	out << ") rotate by -25 nomirror\nplot ";
	for ( std::size_t i = 0; i < plot.series.size(); ++i )
	{
		const Series& series = plot.series[i];
		const std::string colour = std::string( " lc rgb '" ) + COLOURS[i % std::size( COLOURS )] + "' ";
		const std::string title = series.name.empty() ? "notitle" : "title " + inQuotes( series.name );
		const std::string data = "$s" + std::to_string( i ) + " using ";
		out << ( i > 0 ? ", \\\n  " : "" );
		if ( series.mark == Mark::LINES || series.mark == Mark::DASHES )
		{
			out << data << "1:2 with lines dt 2 lw 1.4 lc rgb '#777777' " << title;
			continue;
		}
		const double shift = ( static_cast<double>( column++ ) + 0.5 ) * width - 0.4;
		const bool bars = series.mark == Mark::BARS && !plot.y.log; // on a logarithmic axis a bar has no length
		const char* style = bars ? " with boxes" : " with points pt 7 ps 0.7";
		out << data << "($1+" << shift << "):2" << style << colour << title;
		if ( hasSpread( series ) ) // gnuplot's own error bars leave a hole around the point
		{
			out << ", " << data << "($1+" << shift << "):3:(0):($4-$3) with vectors nohead lw 1.4"
			    << ( bars ? " lc rgb '#444444' " : colour ) << "notitle";
		}
	}
	out << "\n";
}

void plotLines( std::ostream& out, const Plot& plot )
{
	bool first = true;
	const auto separate = [&]
	{
		out << ( first ? "plot " : ", \\\n  " );
		first = false;
	};
	for ( std::size_t i = 0; i < plot.series.size(); ++i ) // bands below everything else
	{
		const Series& series = plot.series[i];
		if ( series.mark == Mark::LINES && hasSpread( series ) )
		{
			separate();
			out << "$s" << i << " using 1:3:4 with filledcurves axes x1y" << ( series.second ? 2 : 1 )
			    << " fs transparent solid 0.15 lc rgb '" << COLOURS[i % std::size( COLOURS )] << "' notitle";
		}
	}
	std::size_t colour = 0;
	for ( std::size_t i = 0; i < plot.series.size(); ++i )
	{
		const Series& series = plot.series[i];
		colour = series.name.empty() && i > 0 ? colour : i; // a line without a name belongs to the one before
		const bool many = series.points.size() > 60;
		separate();
		out << "$s" << i << " using 1:2 axes x1y" << ( series.second ? 2 : 1 );
		switch ( series.mark )
		{
		case Mark::POINTS:
			out << " with points pt 7 ps 0.7";
			break;
		case Mark::DASHES:
			out << " with lines dt 2 lw 1.6";
			break;
		case Mark::LINES:
		case Mark::BARS: // without categories there is nothing to stand on
			out << ( many ? " with lines lw 1.4" : " with linespoints pt 7 ps 0.5 lw 1.8" );
			break;
		}
		out << " lc rgb '" << COLOURS[colour % std::size( COLOURS )] << "' "
		    << ( series.name.empty() ? "notitle" : "title " + inQuotes( series.name ) );
	}
	out << "\n";
}

} // namespace

std::string gnuplotScript( const Plot& plot, Picture picture, const std::string& file )
{
	std::ostringstream out;
	const int width = 860;
	std::size_t named = 0, longest = 1;
	for ( const Series& series : plot.series )
	{
		named += !series.name.empty();
		longest = std::max( longest, series.name.size() );
	}
	const std::size_t columns = std::clamp<std::size_t>( 680 / ( 8 * longest + 60 ), 1, 3 );
	const auto key_rows = static_cast<int>( ( named + columns - 1 ) / columns );
	const int label_rows = plot.categories.empty() ? 0 : 5, height = 400 + 20 * ( key_rows + label_rows );
	out << "set encoding utf8\n";
	if ( picture == Picture::SVG )
	{
		out << "set terminal svg noenhanced size " << width << "," << height
		    << " dynamic font 'sans,13' background '#ffffff'\n";
	}
	else
	{
		out << "set terminal pngcairo noenhanced size " << width << "," << height
		    << " font 'sans,10' background '#ffffff'\n";
	}
	// the key's place is kept free by hand: gnuplot lets it run into the label of the axis
	out << "set output " << inQuotes( file ) << "\nset title " << inQuotes( plot.title ) << "\nset bmargin "
	    << 4 + key_rows + label_rows << "\nset key bmargin center horizontal maxcols " << columns
	    << "\nset grid lc rgb '#dddddd' lt 1\nset border lc rgb '#777777'\n"
	       "set tics textcolor rgb '#222222'\nset bars small\n";
	setAxis( out, "y", plot.y );
	if ( !plot.categories.empty() )
	{
		out << "set xlabel " << labelOf( plot.x ) << " offset 0,0.5\n";
	}
	else
	{
		setAxis( out, "x", plot.x );
	}
	setLogTics( out, plot );
	if ( usesSecond( plot ) )
	{
		setAxis( out, "y2", plot.y2 );
		out << "set ytics nomirror\nset y2tics\n";
	}
	for ( std::size_t i = 0; i < plot.series.size(); ++i )
	{
		writeData( out, plot, i );
	}
	if ( plot.series.empty() )
	{
		out << "set xrange [0:1]\nset yrange [0:1]\nplot NaN notitle\n"; // an empty frame rather than an error
	}
	else if ( !plot.categories.empty() )
	{
		plotCategories( out, plot );
	}
	else
	{
		plotLines( out, plot );
	}
	return out.str();
}

namespace
{

void replaceAll( std::string& text, const std::string& from, const std::string& to )
{
	for ( std::size_t at = text.find( from ); at != std::string::npos; at = text.find( from, at + to.size() ) )
	{
		text.replace( at, from.size(), to );
	}
}

} // namespace

std::string embeddedSvg( const std::string& svg, const std::string& prefix )
{
	const std::size_t begin = svg.find( "<svg" );
	std::string out = begin == std::string::npos ? "" : svg.substr( begin );
	for ( const std::array<const char*, 2>& marks : { std::array<const char*, 2>{ "id='", "id='" }, { "id=\"", "id=\"" },
	          { "href='#", "href='#" }, { "href=\"#", "href=\"#" }, { "url(#", "url(#" } } )
	{
		replaceAll( out, marks[0], marks[1] + prefix );
	}
	return out;
}

namespace
{

/// Inside single quotes of a shell.
std::string shellQuoted( const std::string& text )
{
	std::string out = "'";
	for ( const char c : text )
	{
		out += c == '\'' ? std::string( "'\\''" ) : std::string( 1, c );
	}
	return out + "'";
}

} // namespace

bool hasGnuplot()
{
	return std::system( "command -v gnuplot >/dev/null 2>&1" ) == 0;
}

void runGnuplot( const std::string& script )
{
	if ( std::system( ( "LC_ALL=C.UTF-8 gnuplot " + shellQuoted( script ) ).c_str() ) != 0 )
	{
		throw std::runtime_error( script + ": gnuplot could not draw it" );
	}
}
