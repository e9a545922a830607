# Values of src/analysis from spatstat, for what check_against_scipy.py has no other people's code for.
#
#     apt-get install r-cran-spatstat.explore r-cran-jsonlite
#     Rscript tests/analysis/check_against_spatstat.R
#
# writes spatstat.json beside golden.json, whose points it takes; tests/analysis.rs compares. Classes are dealt in turn.

suppressPackageStartupMessages(library(spatstat.explore))
library(jsonlite)

here <- dirname(sub("--file=", "", grep("--file=", commandArgs(FALSE), value = TRUE)))
golden <- fromJSON(file.path(here, "golden.json"))
window <- owin(c(0, golden$size[1]), c(0, golden$size[2]))
a <- ppp(golden$a[, 1], golden$a[, 2], window = window)
marks(a) <- factor(ifelse(seq_len(npoints(a)) %% 3 == 1, "q", "p"))

sigma <- 0.02
radii <- seq(0, 0.16, length.out = 513)
# From 4 sigma on, where dividing by the circumference is what src/analysis does too.
shown <- seq(257, 513, by = 32)
pick <- function(f, column) as.data.frame(f)[[column]][shown]
kernel <- list(kernel = "gaussian", bw = sigma, divisor = "r", correction = "translate")
values <- list(
  sigma = sigma,
  radius = radii[shown],
  pair_correlation = pick(do.call(pcf, c(list(unmark(a), r = radii), kernel)), "trans"),
  cross_correlation = pick(do.call(pcfcross, c(list(a, "p", "q", r = radii), kernel)), "trans"),
  within_correlation = pick(do.call(pcfcross, c(list(a, "q", "q", r = radii), kernel)), "trans"),
  k_open = pick(Kest(unmark(a), r = radii, correction = "translate"), "trans"),
  k_periodic = pick(Kest(unmark(a), r = radii, correction = "periodic"), "per"),
  l_open = pick(Lest(unmark(a), r = radii, correction = "translate"), "trans")
)
writeLines(toJSON(c(list(spatstat = unbox(as.character(packageVersion("spatstat.explore")))), values), digits = 10),
           file.path(here, "spatstat.json"))
