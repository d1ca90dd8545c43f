// The names in claims.md.
#include "suite/cases/common/claims.h"

#include "suite/cases/jpo/gradient_alignment/quantities.h"

namespace physinv::alignment {
namespace {

void add_shares(ClaimNames& names) {
  names.set("known_sum", Shares{"known", &Fig2::known_sum});
  names.set("known_vote", Shares{"known", &Fig2::known_vote});
  names.set("unequal_sum", Shares{"unequal", &Fig2::unequal_sum});
  names.set("unequal_vote", Shares{"unequal", &Fig2::unequal_vote});
  names.set("linear", Shares{"linear", &Fig2::linear});
  names.set("noise_free", Shares{"sine", &Fig2::free});
  names.set("noisy_sum", Shares{"sine", &Fig2::sum});
  names.set("noisy_vote", Shares{"sine", &Fig2::vote});
}

void add_theories(ClaimNames& names) {
  const auto set = [&](const char* name, double (*law)(Index)) {
    names.set(name, Theory([=](const Fig2&, Index n) { return law(n); }));
  };
  set("p_sum", sum_weak);
  set("p_vote", vote_weak);
  set("p_vote_printed", vote_printed);
  set("p_sum_noisy", sum_even);
  set("p_vote_noisy", vote_even);
  names.set("rho", Theory([](const Fig2& f, Index n) {
              return Fig2::rho(n, f.paper);
            }));
  names.set("combined_sum", Theory([](const Fig2& f, Index n) {
              return f.combined(n, sum_even(n));
            }));
  names.set("combined_vote", Theory([](const Fig2& f, Index n) {
              return f.combined(n, vote_even(n));
            }));
}

/// From theory, or from other shares.
void add_distances(ClaimNames& names) {
  names.add("off_by", off_by);
  names.add("largest_distance", largest_distance);
  names.add("largest_distance",
            [](const Shares& a, const Theory& b, Index first) {
              return largest_distance(a, b, first);
            });
  names.add("largest_distance", [](const Shares& a, const Theory& b) {
    return largest_distance(a, b);
  });
  names.add("largest_distance",
            [](const Shares& a, const Shares& b, Index first) {
              return largest_distance(a, measured(b), first);
            });
  names.add("largest_excess", largest_excess);
  names.add("largest_excess",
            [](const Shares& a, const Shares& b, Index first) {
              return largest_excess(a, measured(b), first);
            });
  names.add("mean_excess", mean_excess);
  names.add("end_distance", end_distance);
  names.add("end_in_errors", end_in_errors);
  names.add("end_distance_in_errors", end_distance_in_errors);
  names.add("slope_off", slope_off);
  names.add("slope_in_errors", [](const Shares& a, double b, Index last) {
    return slope_in_errors(a, b, last);
  });
  names.add("slope_in_errors",
            [](const Shares& a, const Theory& b, Index last) {
              return slope_in_errors(a, b, last);
            });
  names.add("slope_in_errors",
            [](const Shares& a, const Shares& b, Index last) {
              return slope_in_errors(a, b, last);
            });
}

/// Of the response model that is fitted to noise-free updates.
Quantity fitted(double Response::*parameter) {
  return fig2("sine", [=](const Fig2& f) {
    return std::optional(f.sine_fit->response.*parameter);
  });
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  add_shares(names);
  add_theories(names);
  add_distances(names);
  names.add("largest_rise_of_doubling", largest_rise_of_doubling);
  names.add("largest_outside", largest_outside);
  names.add("highest_share", highest_share);
  names.add("lowest_share", lowest_share);
  names.add("share_at", share_at);
  names.add("fall", fall);
  names.add("last_share", last_share);
  names.add("slope", slope);
  names.add("apart_from_vote", apart_from_vote);
  names.set("fitted_complexity", fitted(&Response::complexity));
  names.set("fitted_plasticity", fitted(&Response::plasticity));
  names.set("rms_of_fit", fig2("sine", [](const Fig2& f) {
              return std::optional(f.sine_fit->rms);
            }));
  add_claims_of_folder(r, "jpo/gradient_alignment", names);
}

}  // namespace physinv::alignment
