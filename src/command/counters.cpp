#include "src/command/counters.hpp"

#include "partition/traffic.hpp"

#include <nlohmann/json.hpp>

namespace taut::command {

namespace {

using Json = nlohmann::ordered_json;

struct Count {
  const char* name;
  double PhaseTraffic::*seconds = nullptr;
  Global PhaseTraffic::*number = nullptr;

  double of(const PhaseTraffic& t) const { return seconds ? t.*seconds : double(t.*number); }
};

constexpr std::array counts{Count{"entered", nullptr, &PhaseTraffic::entered},
                            Count{"seconds", &PhaseTraffic::seconds, nullptr},
                            Count{"work_seconds", &PhaseTraffic::work, nullptr},
                            Count{"messages", nullptr, &PhaseTraffic::messages},
                            Count{"bytes", nullptr, &PhaseTraffic::bytes},
                            Count{"neighbours", nullptr, &PhaseTraffic::neighbours},
                            Count{"reductions", nullptr, &PhaseTraffic::reductions},
                            Count{"collectives", nullptr, &PhaseTraffic::collectives},
                            Count{"halo_updates", nullptr, &PhaseTraffic::halo_updates},
                            Count{"halo_messages", nullptr, &PhaseTraffic::halo_messages},
                            Count{"halo_bytes", nullptr, &PhaseTraffic::halo_bytes}};

Json describe(std::span<const double> sums, std::span<const double> largest, int ranks) {
  Json phase;
  for (std::size_t k = 0; k < counts.size(); ++k)
    phase[counts[k].name] = {{"sum", sums[k]}, {"mean", sums[k] / ranks}, {"max", largest[k]}};
  const double mean_work = sums[2] / ranks;
  phase["imbalance"] = mean_work > 0 ? largest[2] / mean_work : 1.0;
  return phase;
}

} // namespace

std::string counters_text(MPI_Comm comm, const Totals& totals, Global rejected_steps) {
  const auto here = traffic();
  std::vector<double> sums;
  for (const PhaseTraffic& t : here)
    for (const Count& c : counts) sums.push_back(c.of(t));
  std::vector<double> largest = sums;
  sum_in_place(comm, sums);
  max_in_place(comm, largest);
  Json json = {{"ranks", size_of(comm)}, {"steps", totals.steps}, {"rejected_steps", rejected_steps}};
  for (std::size_t p = 0; p < here.size(); ++p)
    json["phases"][std::string(phase_names[p])] =
        describe(std::span(sums).subspan(p * counts.size(), counts.size()),
                 std::span(largest).subspan(p * counts.size(), counts.size()), size_of(comm));
  json["phases"]["velocity"]["solves"] = totals.steps;
  json["phases"]["projection"]["solves"] = totals.counts.iterations;
  json["phases"]["velocity"]["iterations"] = totals.counts.velocity_iterations;
  json["phases"]["projection"]["iterations"] = totals.counts.linear_iterations;
  return json.dump(2) + "\n";
}

} // namespace taut::command
