#include "support/runs.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <ostream>

namespace ricochet::test {

namespace {

template <class Predicate>
std::vector<Way> ways_where(Predicate const& wanted)
{
  std::vector<Way> ways;
  std::copy_if(all_ways().begin(), all_ways().end(), std::back_inserter(ways), wanted);
  return ways;
}

} // namespace

std::vector<Way> const& all_ways()
{
  static std::vector<Way> const ways = [] {
    std::vector<Way> result;
    for (auto const engine : {EngineKind::sweep, EngineKind::simultaneous})
      for (auto const precision : {Precision::double_, Precision::single_})
        for (auto const placement : {Placement::serial, Placement::parallel})
          result.push_back({engine, precision, placement});
    return result;
  }();
  return ways;
}

std::vector<Way> const& double_ways()
{
  static auto const ways =
      ways_where([](Way const& way) { return way.precision == Precision::double_; });
  return ways;
}

std::vector<Way> const& single_ways()
{
  static auto const ways =
      ways_where([](Way const& way) { return way.precision == Precision::single_; });
  return ways;
}

std::vector<Way> const& sweep_ways()
{
  static auto const ways = ways_where([](Way const& way) {
    return way.precision == Precision::double_ && way.engine == EngineKind::sweep;
  });
  return ways;
}

std::string name(Way const& way)
{
  return std::string(name(way.engine)) + "_" + name(way.precision) +
         (way.placement == Placement::serial ? "_serial" : "_parallel");
}

std::ostream& operator<<(std::ostream& out, Way const& way)
{
  return out << name(way);
}

std::vector<Way> ways_of(EngineKind engine)
{
  std::vector<Way> ways;
  for (auto const precision : {Precision::double_, Precision::single_})
    for (auto const placement : {Placement::serial, Placement::parallel})
      ways.push_back({engine, precision, placement});
  return ways;
}

Run start(Scene const& scene, Way const& way)
{
  return {make_engine(scene.model,
                      {way.engine, way.precision, scene.dt, way.placement, way.execution},
                      scene.discs),
          scene.discs.size()};
}

std::vector<DiscState> states(Run const& run)
{
  std::vector<DiscState> result(run.discs);
  run->states(result.data());
  return result;
}

std::int64_t long_run(Way const& way, std::int64_t steps)
{
  return way.placement == Placement::serial ? steps : steps / 10;
}

std::vector<DiscState> states_after(Scene const& scene, Way const& way, std::int64_t steps)
{
  auto const engine = start(scene, way);
  engine->advance(steps);
  return states(engine);
}

Report report_after(Scene const& scene, Way const& way, std::int64_t steps)
{
  auto const engine = start(scene, way);
  engine->advance(steps);
  return engine->report();
}

double round_off(Precision precision)
{
  return precision == Precision::double_ ? std::numeric_limits<double>::epsilon() / 2
                                         : double{std::numeric_limits<float>::epsilon()} / 2;
}

} // namespace ricochet::test
