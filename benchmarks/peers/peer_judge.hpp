// SPDX-License-Identifier: BSD-3-Clause
// Judging where leeway and its peers disagree: questions, verdicts, and rows of a report.
//
// Every answer is compared with leeway's exact distance first. If an answer of any library, leeway included, is off by more
// than 1e-6 m, brute force measures all pieces of the shapes in question (tests/support/brute_distance.hpp). Its result is
// the truth for all libraries, and each answer that it contradicts is counted, kept and explained.
#pragma once

#include "peers/brute_truth.hpp"
#include "peers/peers.hpp"

#include "brute_distance.hpp"

#include <map>

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double AGREEMENT = 1e-6; ///< metres
constexpr std::size_t BLOCK = 16;  ///< questions to one library in a row

struct Question
{
	std::string name;
	double alpha = 0;     ///< of a distance
	bool verdict = false; ///< is the distance at or below `margin`?
	double margin = 0;
	double relativeError() const { return alpha / ( 1 - alpha ); } ///< found <= (1 + this) true, as peers have it
};

inline Answer single( double value )
{
	return { value, value };
}

/// A library that was asked, and two of its properties that can explain errors.
struct Asked
{
	Contender contender;
	double shape_error = 0; ///< PeerEngine::shapeError() of two bodies together, at most
	bool has_solids = true;
};

/// One question put to all libraries about the same things, leeway first.
class Trial
{
public:
	/// @param brute the truth about a thing, by its number
	Trial( const Question& question, std::vector<Asked> asked, std::function<Truth( std::size_t, double bound )> brute )
	    : m_question( question ), m_asked( std::move( asked ) ), m_brute( std::move( brute ) )
	{
	}

	/// Asks all about things 0 to count - 1.
	/// @param truth leeway's exact distances; empty: its answers now, which are exact distances
	void run( std::size_t count, int repetitions, std::vector<double> truth = {} );
	const std::vector<double>& truth() const { return m_truth; }

	const Answer& answer( std::size_t contender, std::size_t thing ) const { return m_runs[contender].answers[thing]; }

	/// Rows of some of the things. @param judged false: only their times
	void report( PeerReport& out, const std::string& workload, const std::vector<std::size_t>& members, bool judged = true );

private:
	struct Wrong
	{
		double by = 0; ///< metres; infinite for a contact that was not seen
		std::string why;
	};
	Wrong judge( std::size_t contender, std::size_t member, const Truth& truth ) const;
	/// leeway's answer, or brute force's where a library contradicts leeway.
	Truth truthOf( std::size_t member );

	const Question m_question;
	const std::vector<Asked> m_asked;
	const std::function<Truth( std::size_t, double )> m_brute;
	std::vector<Run> m_runs;
	std::vector<double> m_truth;
	std::map<std::size_t, Truth> m_examined;
};

/// The number of a thing: contenders get a pointer to it as a double.
inline std::size_t numberOf( const double* state )
{
	return static_cast<std::size_t>( *state );
}

/// Numbers of the things whose distance is of a kind.
std::vector<std::size_t> where( const std::vector<double>& truth, const std::function<bool( double )>& holds );
