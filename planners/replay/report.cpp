// SPDX-License-Identifier: BSD-3-Clause
// The answers over a drive, for files and for people.
#include "replay/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace leeway::replay
{
namespace
{

using motions::Json;
using motions::jsonNumber;

/// Median, 99 % and largest.
struct Spread
{
	double median = 0, most_of = 0, largest = 0;
};

Spread spreadOf( std::vector<double> values )
{
	if ( values.empty() )
	{
		return {};
	}
	std::sort( values.begin(), values.end() );
	const auto at = [&]( double share )
	{ return values[static_cast<std::size_t>( share * static_cast<double>( values.size() - 1 ) )]; };
	return { at( 0.5 ), at( 0.99 ), values.back() };
}

std::vector<double> timesOf( const Result& result )
{
	std::vector<double> times;
	for ( const Cycle& cycle : result.cycles )
	{
		times.push_back( cycle.microseconds );
	}
	return times;
}

Json jsonOf( const Spread& spread )
{
	return { { "median_us", spread.median }, { "p99_us", spread.most_of }, { "max_us", spread.largest } };
}

/// How often the cloud got a frame.
struct FrameRate
{
	double per_second = std::numeric_limits<double>::quiet_NaN(); ///< NaN: there are not two frames
	double longest = 0;                                           ///< seconds between two sights that follow each other
};

FrameRate rateOf( std::vector<double> frames )
{
	FrameRate rate;
	std::sort( frames.begin(), frames.end() ); // those of several sensors come in any order
	for ( std::size_t i = 1; i < frames.size(); ++i )
	{
		rate.longest = std::max( rate.longest, frames[i] - frames[i - 1] );
	}
	if ( frames.size() > 1 && frames.back() > frames.front() )
	{
		rate.per_second = static_cast<double>( frames.size() - 1 ) / ( frames.back() - frames.front() );
	}
	return rate;
}

std::size_t count( const Result& result, lw_verdict verdict )
{
	return static_cast<std::size_t>( std::count_if(
	    result.cycles.begin(), result.cycles.end(), [&]( const Cycle& cycle ) { return cycle.verdict == verdict; } ) );
}

} // namespace

Json toJson( const Result& result, const Settings& settings )
{
	Json json;
	json["passes"] = result.passes();
	json["cycles"] = result.cycles.size();
	json["rate"] = settings.rate;
	json["budget_us"] = jsonNumber( settings.budget );
	for ( const lw_verdict verdict : { LW_VERDICT_FREE, LW_VERDICT_BLOCKED, LW_VERDICT_UNDECIDED } )
	{
		json["answers"][lw_verdict_name( verdict )] = count( result, verdict );
	}
	json["answer"] = jsonOf( spreadOf( timesOf( result ) ) );
	json["publish"] = jsonOf( spreadOf( result.publish_microseconds ) );
	json["events"] = result.events;
	json["late"] = result.late;
	const FrameRate rate = rateOf( result.frames );
	json["frames"] = { { "taken", result.frames.size() }, { "per_second", jsonNumber( rate.per_second ) },
	    { "longest_gap", rate.longest } };
	json["rejected"] = result.rejected;
	json["least_scale"] = result.least_scale;
	json["least_scale_at"] = result.least_scale_at;
	json["alarm"] = nullptr;
	if ( result.alarm )
	{
		const Alarm& alarm = *result.alarm;
		Json& out = json["alarm"];
		out["at"] = alarm.at;
		out["verdict"] = lw_verdict_name( alarm.verdict );
		out["time"] = alarm.time;
		out["reason"] = alarm.reason;
		out["self"] = alarm.self;
		out["pair"] = alarm.reason.empty() ? motions::jsonClearance( alarm.pair ) : Json();
		out["brake_by"] = jsonNumber( alarm.brake_by );
	}
	return json;
}

std::string profileCsv( const Result& result )
{
	std::string text = "time,verdict,proved_until,stands,scale,age,microseconds\n";
	for ( const Cycle& c : result.cycles )
	{
		text += fmt::format( "{},{},{},{},{},{},{:.1f}\n", c.time, lw_verdict_name( c.verdict ), c.proved_until, c.stands,
		    c.scale, c.age, c.microseconds );
	}
	return text;
}

std::string describe( const Result& result )
{
	const Spread answer = spreadOf( timesOf( result ) ), publish = spreadOf( result.publish_microseconds );
	std::string text = fmt::format( "cycles      {}: {} FREE, {} BLOCKED, {} UNDECIDED\n", result.cycles.size(),
	    count( result, LW_VERDICT_FREE ), count( result, LW_VERDICT_BLOCKED ), count( result, LW_VERDICT_UNDECIDED ) );
	text += fmt::format(
	    "answers     {:.0f} us median, {:.0f} us 99 %, {:.0f} us at most\n", answer.median, answer.most_of, answer.largest );
	text += fmt::format( "events      {}, {} late; published in {:.0f} us median, {:.0f} us at most\n", result.events,
	    result.late, publish.median, publish.largest );
	if ( !result.frames.empty() )
	{
		const FrameRate rate = rateOf( result.frames );
		text += fmt::format( "frames      {}", result.frames.size() );
		text += std::isnan( rate.per_second ) ? "\n"
		                                      : fmt::format( ", {:.1f} per second, at most {:.0f} ms between two\n",
		                                            rate.per_second, 1e3 * rate.longest );
	}
	for ( const std::string& rejected : result.rejected )
	{
		text += fmt::format( "refused     {}\n", rejected );
	}
	if ( result.least_scale < 1 )
	{
		text += fmt::format(
		    "people      speed scale {:.3f} at {:.3f} s, the least\n", result.least_scale, result.least_scale_at );
	}
	if ( !result.alarm )
	{
		return text + "verdict     FREE in all cycles\n";
	}
	const Alarm& alarm = *result.alarm;
	text +=
	    fmt::format( "alarm       at {:.4f} s: {} at {:.4f} s, ", alarm.at, lw_verdict_name( alarm.verdict ), alarm.time );
	text += alarm.reason.empty()
	            ? fmt::format( "{} and {}, {:.4g} m\n", alarm.pair.first, alarm.pair.second, alarm.pair.upper )
	            : alarm.reason + "\n";
	if ( !std::isnan( alarm.brake_by ) )
	{
		text += fmt::format(
		    "brake by    {:.4f} s: {:.0f} ms after the alarm\n", alarm.brake_by, 1e3 * ( alarm.brake_by - alarm.at ) );
	}
	return text;
}

} // namespace leeway::replay
