// SPDX-License-Identifier: BSD-3-Clause
// Pieces of the JSON reports.
#include "motions/json.hpp"

#include <cmath>

namespace leeway::motions
{

Json jsonNumber( double value )
{
	return std::isfinite( value ) ? Json( value ) : Json( nullptr );
}

Json timeFromStart( double seconds )
{
	const auto all = static_cast<std::int64_t>( std::llround( seconds / 1e-9 ) );
	return { { "sec", all / 1000000000 }, { "nanosec", all % 1000000000 } };
}

std::string jsonText( const Json& json )
{
	return json.dump( 2, ' ', false, Json::error_handler_t::replace ) + "\n";
}

Json jsonClearance( const Named& clearance )
{
	if ( !clearance.asked )
	{
		return nullptr;
	}
	Json json;
	json["lower"] = jsonNumber( clearance.lower );
	json["upper"] = jsonNumber( clearance.upper );
	json["pair"] = clearance.first.empty() ? Json( nullptr ) : Json{ clearance.first, clearance.second };
	if ( clearance.margin > 0 )
	{
		json["margin"] = clearance.margin;
	}
	if ( clearance.has_points )
	{
		const auto point = []( const lw_vec3& p ) { return Json{ p.x, p.y, p.z }; };
		json["points"] = Json{ point( clearance.point_a ), point( clearance.point_b ) };
	}
	return json;
}

} // namespace leeway::motions
