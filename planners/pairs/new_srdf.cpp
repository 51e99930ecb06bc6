// SPDX-License-Identifier: BSD-3-Clause
// Selects the pairs that the new SRDF disables, with reasons, and counts the states that it leaves free.
#include "leeway/pairs/new_srdf.hpp"
#include "pairs/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace leeway::pairs
{
namespace
{

/// A share of free states below this makes planners that sample states slow or helpless: the pairs that block are named.
constexpr double usable_share = 0.05;
constexpr std::size_t most_blocking = 5; // that are named
constexpr std::size_t most_listed = 20;  // pairs enabled again, without --verbose
/// The SRDF says Default or Always of a pair. The claim stays if the pair is in contact in this share of the random states at least, or
/// where MoveIt looks for contact.
constexpr double supported_claim = 0.1;

bool isClaimOfContact( const PairRow& row )
{
	return row.disabled && io::isComputedReason( row.reason ) &&
	       ( row.reason.rfind( "Default", 0 ) == 0 || row.reason.rfind( "Always", 0 ) == 0 );
}

std::string neverReason( const PairRow& row )
{
	return row.pair.proof == LW_PROOF_HULL ? "Never (hulls apart)" : "Never (joint box certified)";
}

/// Why the pair is disabled for its contact. Empty: it is not.
std::string contactReason( PairTable& table, const PairRow& row )
{
	if ( row.always || PairTable::touchByDesign( row ) )
	{
		const bool nearly = row.always || row.contactShare() >= nearly_all;
		return fmt::format( "{} ({})", nearly ? "Always" : "Default", contactText( row ) );
	}
	if ( table.touchAtDefault( row ) )
	{
		return fmt::format( "Default (in contact at the default state{})",
		    row.states > 0 ? fmt::format( ", and in {} of {} random states", percent( row.contactShare() ), row.states )
		                   : "" );
	}
	const bool supported = row.contactShare() >= supported_claim || table.touchAtMiddle( row );
	return isClaimOfContact( row ) && supported ? fmt::format( "Default ({})", contactText( row ) ) : "";
}

/// Empty: the pair is to be checked.
std::string newReason( PairTable& table, const PairRow& row )
{
	if ( row.pair.adjacent )
	{
		return "Adjacent";
	}
	if ( row.pair.kind == LW_PAIR_RIGID )
	{
		return "Never (rigidly attached)";
	}
	if ( row.pair.separation > 0 )
	{
		return neverReason( row );
	}
	const std::string contact = contactReason( table, row );
	if ( contact.empty() && row.never_seen > 0 )
	{
		return fmt::format( "Never (evidence only: no contact in {} random states)", row.never_seen );
	}
	return contact;
}

/// Sentences of the usability report count with these: is the pair checked?
struct Checked
{
	const PairTable& table;
	const NewSrdf* srdf; ///< nullptr: with the SRDF that was given
	bool operator()( std::size_t row ) const { return srdf != nullptr ? !srdf->disabled[row] : !table.rows()[row].disabled; }
};

std::string shareText( const ContactSamples& samples, std::size_t states )
{
	return percent( static_cast<double>( states ) / samples.states() );
}

std::size_t freeWith( const PairTable& table, const ContactSamples& samples, const NewSrdf* srdf )
{
	return samples.freeStates( Checked{ table, srdf } );
}

/// Of the states that the new SRDF blocks, how many would be free if pairs enabled again were still disabled.
std::size_t costOfEnabledAgain( const PairTable& table, const ContactSamples& samples, const NewSrdf& srdf )
{
	std::vector<bool> checked( table.rows().size() );
	for ( std::size_t row = 0; row < checked.size(); ++row )
	{
		checked[row] = !srdf.disabled[row];
	}
	for ( const PairRow* row : srdf.enabled_again )
	{
		checked[static_cast<std::size_t>( row - table.rows().data() )] = false;
	}
	return samples.freeStates( [&]( std::size_t row ) { return checked[row]; } ) - freeWith( table, samples, &srdf );
}

/// A pair that is checked and in contact at the default state; empty if there is none.
std::string touchingAtDefault( PairTable& table, const NewSrdf* srdf )
{
	const Checked checked{ table, srdf };
	for ( std::size_t i = 0; i < table.rows().size(); ++i )
	{
		const PairRow& row = table.rows()[i];
		if ( checked( i ) && row.pair.kind != LW_PAIR_RIGID && table.touchAtDefault( row ) )
		{
			return pairText( row );
		}
	}
	return "";
}

std::string blockingText( const PairTable& table, const ContactSamples& samples, const NewSrdf* srdf )
{
	const std::vector<ContactSamples::Blocking> pairs = samples.blocking( Checked{ table, srdf } );
	std::string text = "  the pairs that block most of them:\n";
	for ( std::size_t i = 0; i < std::min( pairs.size(), most_blocking ); ++i )
	{
		text += fmt::format( "    {}: in contact in {}, alone in {}\n", pairText( table.rows()[pairs[i].row] ),
		    shareText( samples, pairs[i].states ), shareText( samples, pairs[i].alone ) );
	}
	return text +
	       ( srdf != nullptr
	               ? "    if their shapes are meant to overlap, disable them in the SRDF with a reason of your own, which is kept; else narrow the "
	                 "joint limits, or correct the shapes\n"
	               : "    --out writes an SRDF without the pairs that touch by design\n" );
}

} // namespace

std::string percent( double share )
{
	return share >= 1 ? "100 %" : fmt::format( "{:.1f} %", std::floor( 1000 * share ) / 10 );
}

std::string pairText( const PairRow& row )
{
	return row.first + " - " + row.second;
}

std::string contactText( const PairRow& row )
{
	if ( row.states > 0 && row.contacts > 0 )
	{
		return row.contacts == row.states
		           ? fmt::format( "in contact in all {} random states", row.states )
		           : fmt::format( "in contact in {} of {} random states", percent( row.contactShare() ), row.states );
	}
	return row.always ? "in contact in every measured state" : "in contact where the search led";
}

NewSrdf newSrdf( PairTable& table, const io::RobotModel& model )
{
	std::vector<io::DisabledPair> pairs;
	for ( const PairRow& row : table.rows() )
	{
		const std::string reason = newReason( table, row );
		if ( !reason.empty() )
		{
			pairs.push_back( { row.first, row.second, reason } );
		}
	}
	NewSrdf result;
	result.document = io::writeSrdf( model, pairs );
	std::map<std::pair<std::string, std::string>, std::string> now_disabled;
	for ( const std::vector<io::DisabledPair>* list : { &result.document.written, &result.document.kept } )
	{
		for ( const io::DisabledPair& pair : *list )
		{
			now_disabled.emplace( std::minmax( pair.link1, pair.link2 ), pair.reason );
		}
	}
	for ( const PairRow& row : table.rows() )
	{
		const auto found = now_disabled.find( { row.first, row.second } );
		const bool computed = row.disabled && io::isComputedReason( row.reason );
		result.disabled.push_back( found != now_disabled.end() || ( row.disabled && !computed ) );
		if ( found == now_disabled.end() && computed )
		{
			result.enabled_again.push_back( &row );
		}
		const bool for_contact = found != now_disabled.end() &&
		                         ( found->second.rfind( "Default (", 0 ) == 0 || found->second.rfind( "Always (", 0 ) == 0 );
		if ( for_contact && !row.always )
		{
			result.free_elsewhere.push_back( &row );
		}
	}
	std::stable_sort( result.enabled_again.begin(), result.enabled_again.end(),
	    []( const PairRow* x, const PairRow* y ) { return x->contacts > y->contacts; } );
	return result;
}

std::string describe( const NewSrdf& srdf, const std::string& file, bool verbose )
{
	std::map<std::string, std::size_t> reasons;
	for ( const io::DisabledPair& pair : srdf.document.written )
	{
		// shares differ from pair to pair
		const std::size_t contact = pair.reason.find( " (in contact" );
		++reasons[pair.reason.substr( 0, contact ) + ( contact != std::string::npos ? " (in contact ...)" : "" )];
	}
	std::string text = fmt::format( "new SRDF {}: {} pairs disabled, {} of them unchanged\n", file,
	    srdf.document.written.size() + srdf.document.kept.size(), srdf.document.kept.size() );
	for ( const auto& [reason, count] : reasons )
	{
		text += fmt::format( "  {:>6} {}\n", count, reason );
	}
	for ( std::size_t i = 0; i < srdf.enabled_again.size() && ( verbose || i < most_listed ); ++i )
	{
		const PairRow* row = srdf.enabled_again[i];
		text += fmt::format( "  enabled again: {} was disabled as {}, {}\n", pairText( *row ), row->reason,
		    row->pair.closest > 0 ? "which is not proved" : "but is " + contactText( *row ) );
	}
	if ( !verbose && srdf.enabled_again.size() > most_listed )
	{
		text += fmt::format( "  ... and {} more (--verbose shows all)\n", srdf.enabled_again.size() - most_listed );
	}
	for ( const PairRow* row : srdf.free_elsewhere )
	{
		text += fmt::format(
		    "  disabled for its contact, but free in other states: {}, {}\n", pairText( *row ), contactText( *row ) );
	}
	return text;
}

std::string describeNear( const PairTable& table, const ContactSamples& samples, const NewSrdf* srdf )
{
	std::string text;
	for ( const NearRange& range : samples.near() )
	{
		const PairRow& row = table.rows()[range.row];
		const bool disabled = srdf != nullptr ? srdf->disabled[range.row] : row.disabled;
		text += fmt::format( "near by design: {} {:.3g} to {:.3g} mm in {} random states{}{}\n", pairText( row ),
		    1000 * range.least, 1000 * range.most, range.states,
		    row.pair.closest < range.least ? fmt::format( ", closest seen {:.3g} mm", 1000 * row.pair.closest ) : "",
		    disabled ? "; disabled" : "" );
	}
	return text.empty()
	           ? ""
	           : text +
	                 "  (nothing to set while --min-d and --self-margin are below the smaller number; disable a pair with a reason of "
	                 "your own if it may touch)\n";
}

std::string describeUse( PairTable& table, const ContactSamples& samples, const io::RobotModel& model, const NewSrdf* srdf )
{
	if ( samples.states() == 0 )
	{
		return "";
	}
	const std::size_t given = freeWith( table, samples, nullptr );
	const std::size_t last = srdf != nullptr ? freeWith( table, samples, srdf ) : given;
	std::string text = fmt::format( "free of self contact, of {} random states: {} {}", samples.states(),
	    shareText( samples, given ), model.srdf_file.empty() ? "without an SRDF" : "with the SRDF given" );
	text += srdf != nullptr ? fmt::format( ", {} with the new one\n", shareText( samples, last ) ) : "\n";
	const std::size_t cost = srdf != nullptr ? costOfEnabledAgain( table, samples, *srdf ) : 0;
	if ( cost > 0 )
	{
		text += fmt::format( "  the pairs enabled again ({}) block {} that would be free without them\n",
		    srdf->enabled_again.size(), shareText( samples, cost ) );
	}
	const std::string home = touchingAtDefault( table, srdf );
	text += home.empty() ? "  the default state is free\n" : fmt::format( "  the default state is not free: {}\n", home );
	if ( static_cast<double>( last ) < usable_share * samples.states() )
	{
		text += blockingText( table, samples, srdf );
	}
	return text;
}

void addUse(
    Json& json, const PairTable& table, const ContactSamples& samples, const io::RobotModel& model, const NewSrdf* srdf )
{
	json["near"] = Json::array();
	for ( const NearRange& range : samples.near() )
	{
		const PairRow& row = table.rows()[range.row];
		json["near"].push_back( { { "link1", row.first }, { "link2", row.second }, { "least", range.least },
		    { "most", range.most }, { "states", range.states } } );
	}
	Json& use = json["usability"];
	use["states"] = samples.states();
	use["free_given"] = freeWith( table, samples, nullptr );
	use["srdf_given"] = !model.srdf_file.empty();
	use["free_new"] = srdf != nullptr ? Json( freeWith( table, samples, srdf ) ) : Json( nullptr );
	use["cost_of_enabled_again"] = srdf != nullptr ? Json( costOfEnabledAgain( table, samples, *srdf ) ) : Json( nullptr );
	use["blocking"] = Json::array();
	for ( const ContactSamples::Blocking& pair : samples.blocking( Checked{ table, srdf } ) )
	{
		const PairRow& row = table.rows()[pair.row];
		use["blocking"].push_back(
		    { { "link1", row.first }, { "link2", row.second }, { "states", pair.states }, { "alone", pair.alone } } );
	}
}

} // namespace leeway::pairs
