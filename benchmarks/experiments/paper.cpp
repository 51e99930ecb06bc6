// SPDX-License-Identifier: BSD-3-Clause
// The experiment `paper`: figures 4, 9 and 10 of Steinbach, Kuffner, Asfour, Dillmann, "Efficient collision and
// self-collision detection for humanoids based on sphere trees hierarchies", Humanoids 2006.
#include "experiments/paper.hpp"

#include "experiments/experiments.hpp"
#include "support/provenance.hpp"

#include <cstdio>

std::string say( const char* format, double value )
{
	char text[160];
	std::snprintf( text, sizeof text, format, value );
	return text;
}

namespace
{

class PaperExperiment : public Experiment
{
public:
	std::string name() const override { return "paper"; }
	std::string title() const override { return "The paper's experiments"; }
	double expectedSeconds( const ExperimentSettings& settings ) const override
	{
		return settings.smoke ? 5 : settings.quick ? 20 : 120;
	}

	Outcome run( const ExperimentSettings& settings, Progress& progress ) override
	{
		Outcome out;
		out.name = name();
		out.title = title();
		out.about =
		    "Section VI of Steinbach, Kuffner, Asfour and Dillmann (2006), measured with this engine: two cubes, and "
		    "ARMAR-III "
		    "(32,258 triangles) in a cluttered kitchen (69,474 triangles). Their robot was an earlier ARMAR of 16,440 "
		    "triangles "
		    "in a kitchen of 95,000; their axes are not printed in the text, so it is what the text says that is compared. "
		    "Contenders of a comparison take turns question by question in a random order; times are processor time of one "
		    "thread, forward kinematics included.";
		const bool robot = !settings.data.empty();
		PartProgress shapes( progress, 0, robot ? 0.4 : 1 ), rest( progress, 0.4, 1 );
		addPaperShapes( settings, shapes, out );
		if ( robot )
		{
			out.details["data_hash"] = hashFiles( kitchenFiles( settings.data ) );
			addPaperRobot( settings, rest, out );
		}
		return out;
	}
};

} // namespace

std::unique_ptr<Experiment> makePaperExperiment()
{
	return std::make_unique<PaperExperiment>();
}
