// SPDX-License-Identifier: BSD-3-Clause
// The experiment `trade` as a whole: see trade.hpp.
#include "experiments/trade.hpp"

namespace
{

class Trade : public Experiment
{
public:
	explicit Trade( const TradeSettings& trade ) : m_trade( trade ) {}

	std::string name() const override { return "trade"; }
	std::string title() const override { return "Accuracy: what each knob gives up, observed beside promised"; }

	double expectedSeconds( const ExperimentSettings& settings ) const override
	{
		return settings.data.empty() || settings.smoke ? 2 : settings.quick ? 12 : 60;
	}

	void addOptions( Command& command ) override
	{
		command.option( "--inject", m_trade.inject,
		    "put an error into the answers of alpha, min_d, max_d, range, float, slack, certified or steps, to see that the run fails" );
	}

	Outcome run( const ExperimentSettings& settings, Progress& progress ) override
	{
		Outcome out;
		out.name = name();
		out.title = title();
		out.about =
		    "Each knob is turned by itself; every answer is held against what the knob promises. States: ARMAR-III near the "
		    "furniture of the cluttered kitchen, distances by FCL in double. Motions: the humanoid's arm, Fetch's arm and "
		    "random robots, looked at densely by an auditor that knows no certificates. Times are processor time of one "
		    "thread.";
		PartProgress states( progress, 0, 0.3 ), floats( progress, 0.3, 0.35 ), motions( progress, 0.35, 1 );
		addTradeStates( settings, m_trade, states, out );
		addTradeFloats( settings, m_trade, floats, out );
		addTradeMotions( settings, m_trade, motions, out );
		out.details = { { "inject", m_trade.inject } };
		return out;
	}

private:
	TradeSettings m_trade;
};

} // namespace

std::unique_ptr<Experiment> makeTradeExperiment( const TradeSettings& trade )
{
	return std::make_unique<Trade>( trade );
}

std::unique_ptr<Experiment> makeTradeExperiment()
{
	return makeTradeExperiment( TradeSettings() );
}
