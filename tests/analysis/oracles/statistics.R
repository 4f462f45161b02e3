# Statistics of samples.csv and items.csv in R, as JSON on standard output:
#
#   Rscript tests/analysis/oracles/statistics.R > tests/analysis/oracles/statistics.json
#
# Base R and MASS, which comes with it. Where R has no function of its own the definition is written
# out here, independently of coadapt's. So are the studentised range and the noncentral F, which R
# computes to about 1e-8 and 1e-9 (16-point quadrature in ptukey, 4 decimals in qtukey, a series that
# ends at 1e-9 in pf); here they are integrated and summed to the end, and compared with R's own.

suppressPackageStartupMessages(library(MASS))
arguments <- commandArgs(FALSE)
here <- dirname(sub("^--file=", "", grep("^--file=", arguments, value = TRUE)))

out <- list()
put <- function(key, value) out[[key]] <<- unname(as.numeric(value))

solve_for <- function(f, lower, upper) {
  uniroot(f, c(lower, upper), tol = 1e-13, maxiter = 10000)$root
}

near <- function(found, known, tolerance) {
  if (abs(found - known) > tolerance) stop(sprintf("%.17g is not %.17g", found, known))
  found
}

# The noncentral F is a mixture of beta distributions, with weights of a Poisson distribution.
noncentral_f <- function(f, df1, df2, l) {
  j <- 0:ceiling(l / 2 + 40 * sqrt(l / 2 + 10))
  x <- df1 * f / (df1 * f + df2)
  near(sum(dpois(j, l / 2) * pbeta(x, df1 / 2 + j, df2 / 2)), pf(f, df1, df2, ncp = l), 1e-7)
}

# Limits of the noncentrality of an F, as shares of variance explained.
explained <- function(f, df1, df2, n) {
  sapply(c(0.975, 0.025), function(q) {
    if (pf(f, df1, df2) <= q) return(0)
    lambda <- solve_for(function(l) noncentral_f(f, df1, df2, l) - q, 0, 2000)
    lambda / (lambda + n)
  })
}

# The probability that the range of k normal values exceeds each of w. The smallest is z with density
# k phi(z) u^(k-1), u = P(another > z); the others are within w with (u - v)^(k-1). By the
# trapezoidal rule, whose error for what is smooth and falls off like exp(-z^2) is below 1e-16.
range_tail <- function(w, k) {
  step <- 0.1
  z <- outer(seq(-10, 10, by = step), -w / 2, "+")  # most of it lies about -w / 2
  u <- pnorm(z, lower.tail = FALSE)
  v <- pnorm(z + rep(w, each = nrow(z)), lower.tail = FALSE)
  step * colSums(k * dnorm(z) * u^(k - 1) * -expm1((k - 1) * log1p(-pmin(v / u, 1))))
}

# Divided by the square root of a chi-squared over its degrees of freedom: the studentised range.
studentised_tail <- function(q, k, df) {
  part <- function(s) {
    density <- exp(log(2 * df * s) + dchisq(df * s^2, df, log = TRUE))
    density * range_tail(q * s, k)
  }
  breaks <- c(0, sqrt(qchisq(c(1e-12, 1e-6, 1e-3, 0.1, 0.5, 0.9, 0.999, 1 - 1e-12), df) / df))
  breaks <- c(breaks, tail(breaks, 1) * 2)
  found <- sum(sapply(seq_len(length(breaks) - 1), function(i) {
    integrate(part, breaks[i], breaks[i + 1], rel.tol = 1e-10, abs.tol = 1e-15,
              subdivisions = 1000)$value
  }))
  near(found, ptukey(q, k, df, lower.tail = FALSE), 1e-7)
}

studentised_point <- local({
  known <- list()
  function(k, df) {
    key <- sprintf("%d/%.17g", k, df)
    if (is.null(known[[key]])) {
      about <- qtukey(0.95, k, df)
      found <- uniroot(function(q) studentised_tail(q, k, df) - 0.05, about + c(-1e-3, 1e-3),
                       tol = 1e-12)$root
      known[[key]] <<- near(found, about, 1e-4)
    }
    known[[key]]
  }
})

cramer <- function(x2, df, n) {
  sapply(c(0.975, 0.025), function(q) {
    if (pchisq(x2, df) <= q) return(0)
    min(1, sqrt(solve_for(function(l) pchisq(x2, df, ncp = l) - q, 0, 2000) / n))
  })
}

hedges <- function(x, y) {
  n1 <- length(x); n2 <- length(y); df <- n1 + n2 - 2
  sp <- sqrt(((n1 - 1) * var(x) + (n2 - 1) * var(y)) / df)
  (mean(x) - mean(y)) / sp * (1 - 3 / (4 * (n1 + n2) - 9))
}

hedges_limits <- function(x, y) {
  n1 <- length(x); n2 <- length(y); df <- n1 + n2 - 2
  sp <- sqrt(((n1 - 1) * var(x) + (n2 - 1) * var(y)) / df)
  s <- sqrt(1 / n1 + 1 / n2); t <- (mean(x) - mean(y)) / sp / s
  sapply(c(0.975, 0.025), function(q) {
    solve_for(function(l) pt(t, df, ncp = l) - q, -30, 30) * s * (1 - 3 / (4 * (n1 + n2) - 9))
  })
}

newcombe <- function(theta, m, n) {
  z <- qnorm(0.975)
  f <- function(t) {
    v <- t * (1 - t) * (1 + ((m + n) / 2 - 1) * ((1 - t) / (2 - t) + t / (1 + t))) / (m * n)
    (theta - t)^2 - z^2 * v
  }
  c(solve_for(f, 0, theta), solve_for(f, theta, 1))
}

rows <- read.csv(file.path(here, "samples.csv"), stringsAsFactors = FALSE)
for (d in unique(rows$dataset)) {
  part <- rows[rows$dataset == d, ]
  groups <- split(part$value, part$group)
  y <- part$value; g <- factor(part$group); n <- length(y); k <- nlevels(g)
  p <- function(name) paste(d, name, sep = "/")

  kw <- kruskal.test(y, g)
  put(p("kruskal/statistic"), kw$statistic); put(p("kruskal/p"), kw$p.value)
  e <- unname(kw$statistic) / (n - 1)
  put(p("kruskal/effect"), e)
  r <- summary(aov(rank(y) ~ g))[[1]]
  limits <- explained(r[1, "F value"], k - 1, n - k, n)
  put(p("kruskal/low"), limits[1]); put(p("kruskal/high"), limits[2])

  a <- summary(aov(y ~ g))[[1]]
  f <- a[1, "F value"]
  put(p("anova/statistic"), f); put(p("anova/p"), a[1, "Pr(>F)"])
  between <- a[1, "Sum Sq"]; within <- a[2, "Sum Sq"]; ms <- a[2, "Mean Sq"]
  put(p("anova/eta"), between / (between + within))
  put(p("anova/omega"), (between - (k - 1) * ms) / (between + within + ms))
  limits <- explained(f, k - 1, n - k, n)
  put(p("anova/low"), limits[1]); put(p("anova/high"), limits[2])

  w <- oneway.test(y ~ g)
  put(p("welch/statistic"), w$statistic); put(p("welch/p"), w$p.value)
  put(p("welch/df2"), w$parameter[2])

  away <- abs(y - ave(y, g, FUN = median))
  levene <- summary(aov(away ~ g))[[1]]
  put(p("levene/statistic"), levene[1, "F value"]); put(p("levene/p"), levene[1, "Pr(>F)"])

  fit <- polr(factor(y, ordered = TRUE) ~ g, control = list(reltol = 1e-15, maxit = 5000))
  if (length(unique(y)) <= 10) {
    null <- sum(table(y) * log(table(y) / n))
    ratio <- 2 * (as.numeric(logLik(fit)) - null)
    put(p("logit/statistic"), ratio)
    put(p("logit/p"), pf(ratio / (k - 1), k - 1, n - k, lower.tail = FALSE))
  }

  t <- TukeyHSD(aov(y ~ g))$g
  ms_df <- n - k
  all_p <- c()
  for (i in 1:(k - 1)) for (j in (i + 1):k) {
    q <- function(name) p(paste(names(groups)[i], names(groups)[j], name, sep = "/"))
    x <- groups[[i]]; z <- groups[[j]]
    row <- t[paste(names(groups)[j], names(groups)[i], sep = "-"), ]
    error <- sqrt(within / ms_df / 2 * (1 / length(x) + 1 / length(z)))
    apart <- mean(x) - mean(z); reach <- studentised_point(k, ms_df) * error
    put(q("tukey/difference"), near(apart, -row["diff"], 1e-12))
    put(q("tukey/p"), near(studentised_tail(abs(apart) / error, k, ms_df), row["p adj"], 1e-7))
    put(q("tukey/low"), near(apart - reach, -row["upr"], 1e-4))
    put(q("tukey/high"), near(apart + reach, -row["lwr"], 1e-4))
    put(q("g"), hedges(x, z))
    limits <- hedges_limits(x, z)
    put(q("g_low"), limits[1]); put(q("g_high"), limits[2])

    vx <- var(x) / length(x); vz <- var(z) / length(z)
    df <- (vx + vz)^2 / (vx^2 / (length(x) - 1) + vz^2 / (length(z) - 1))
    range <- abs(mean(x) - mean(z)) / sqrt((vx + vz) / 2)
    put(q("games_howell/statistic"), range); put(q("games_howell/df"), df)
    put(q("games_howell/p"), studentised_tail(range, k, df))
    reach <- studentised_point(k, df) * sqrt((vx + vz) / 2)
    put(q("games_howell/low"), apart - reach); put(q("games_howell/high"), apart + reach)

    u <- suppressWarnings(wilcox.test(x, z))
    put(q("mann_whitney/U1"), u$statistic); put(q("mann_whitney/p"), u$p.value)
    all_p <- c(all_p, u$p.value)
    theta <- unname(u$statistic) / (length(x) * length(z))
    put(q("mann_whitney/r"), 2 * theta - 1)
    if (theta > 0 && theta < 1) {
      limits <- 2 * newcombe(theta, length(x), length(z)) - 1
      put(q("mann_whitney/low"), limits[1]); put(q("mann_whitney/high"), limits[2])
    }

    low <- t.test(x, z, mu = -0.5, alternative = "greater")
    high <- t.test(x, z, mu = 0.5, alternative = "less")
    put(q("tost/p"), max(low$p.value, high$p.value))
    put(q("tost/t_low"), low$statistic); put(q("tost/t_high"), high$statistic)
    inside <- t.test(x, z, conf.level = 0.9)$conf.int
    put(q("tost/low"), inside[1]); put(q("tost/high"), inside[2])

    two <- rbind(c(sum(x > 3), sum(x <= 3)), c(sum(z > 3), sum(z <= 3)))
    if (all(colSums(two) > 0)) {
      fisher <- fisher.test(two)
      put(q("fisher/p"), fisher$p.value)
      l <- sapply(1:2, function(m) prop.test(two[m, 1], sum(two[m, ]), correct = FALSE)$conf.int)
      share <- two[, 1] / rowSums(two)
      put(q("fisher/low"), share[1] - share[2] -
        sqrt((share[1] - l[1, 1])^2 + (l[2, 2] - share[2])^2))
      put(q("fisher/high"), share[1] - share[2] +
        sqrt((l[2, 1] - share[1])^2 + (share[2] - l[1, 2])^2))
    }
  }
  put(p("holm"), p.adjust(all_p, "holm")); put(p("bonferroni"), p.adjust(all_p, "bonferroni"))

  many <- t(sapply(groups, function(x) c(sum(x > 3), sum(x <= 3))))
  if (all(colSums(many) > 0) && k > 2) {
    chi <- suppressWarnings(chisq.test(many, correct = FALSE))
    put(p("proportions/statistic"), chi$statistic)
    small <- min(chi$expected) < 5
    put(p("proportions/p"), if (small) fisher.test(many, workspace = 2e7)$p.value else chi$p.value)
    limits <- cramer(unname(chi$statistic), k - 1, n)
    put(p("proportions/low"), limits[1]); put(p("proportions/high"), limits[2])
  }
  for (name in names(groups)) {
    s <- shapiro.test(groups[[name]])
    put(p(paste("shapiro", name, sep = "/")), c(s$statistic, s$p.value))
  }
}

ratings <- read.csv(file.path(here, "items.csv"), stringsAsFactors = FALSE)
for (d in unique(ratings$dataset)) {
  part <- ratings[ratings$dataset == d, ]
  x <- tapply(part$value, list(part$participant, part$item), mean)
  k <- ncol(x); n <- nrow(x)
  alpha <- k / (k - 1) * (1 - sum(apply(x, 2, var)) / var(rowSums(x)))
  put(paste(d, "alpha", sep = "/"), alpha)
  # Feldt (1965)
  put(paste(d, "alpha_low", sep = "/"), 1 - (1 - alpha) * qf(0.975, n - 1, (n - 1) * (k - 1)))
  put(paste(d, "alpha_high", sep = "/"), 1 - (1 - alpha) * qf(0.025, n - 1, (n - 1) * (k - 1)))
  put(paste(d, "item_rest", sep = "/"), sapply(1:k, function(i) {
    if (sd(x[, i]) == 0) NA else cor(x[, i], rowSums(x[, -i, drop = FALSE]))
  }))
  if (k == 2) {
    r <- cor(x[, 1], x[, 2])
    put(paste(d, "spearman_brown", sep = "/"), 2 * r / (1 + r))
    rs <- tanh(atanh(r) + c(-1, 1) * qnorm(0.975) / sqrt(n - 3))
    put(paste(d, "spearman_brown_limits", sep = "/"), 2 * rs / (1 + rs))
  }
}

line <- function(key) {
  values <- paste(sprintf("%.17g", out[[key]]), collapse = ", ")
  sprintf("    \"%s\": [%s]", key, values)
}
cat("{\n  \"R\": \"", paste(R.version$major, R.version$minor, sep = "."), "\",\n", sep = "")
cat("  \"values\": {\n", paste(sapply(names(out), line), collapse = ",\n"), "\n  }\n}\n", sep = "")
