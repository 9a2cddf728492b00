# Draws what study_front measured:  gnuplot -c perf/front.gp DATA OUT.png
set terminal pngcairo size 1300,640 font 'DejaVu Sans,12'
set output ARG2
data = ARG1
set datafile missing '?'
set logscale xy
set xrange [120:7000]
set bars 0.6
set yrange [0.01:120]
set format y '%g'
set xtics (200, 500, 1000, 2000, 5000)
set grid xtics ytics lt 1 lc rgb '#d0d0d0'
set xlabel 'cost  [core-ns per disc and σ/v_{th}]'
set ylabel '|error of Z|  [%]'
set key top right reverse Left samplen 2 spacing 1.1

# An error within one standard error is drawn as the bound |error| + standard error.
is_known(e, s) = abs(e) >= s
known(e, s) = is_known(e, s) ? abs(e) : NaN
bound(e, s) = is_known(e, s) ? NaN : abs(e) + s
drawn(e, s) = is_known(e, s) ? abs(e) : abs(e) + s
low(e, s) = abs(e) > 1.001 * s ? abs(e) - s : 1e-3

array curve[6] = ['sweep, double', 'sweep, single', 'toi, double', 'toi, single', \
                  'events, double (exact)', 'events, single']
array colour[6] = [0xb2182b, 0xf4a582, 0x2166ac, 0x67a9cf, 0x000000, 0x888888]
array mark[6] = [7, 6, 5, 4, 13, 12]
cost(panel) = 1 + 3 * panel

set multiplot layout 1,2 margins 0.06,0.985,0.1,0.93 spacing 0.065
do for [panel = 1:2] {
  c = cost(panel)
  if (panel == 2) { unset key }
  set title 'packing fraction '.(panel == 1 ? '0.2' : '0.5').'  (small numbers: q)'
  plot for [k = 1:6] data index k-1 using c:(drawn(column(c+1), column(c+2))) \
         with lines lc rgb colour[k] lw 1.5 notitle, \
       for [k = 1:6] '' index k-1 using c+0:(known(column(c+1), column(c+2))) :\
         (low(column(c+1), column(c+2))):(abs(column(c+1)) + column(c+2)) \
         with yerrorbars pt mark[k] ps 1.2 lc rgb colour[k] notitle, \
       for [k = 1:6] '' index k-1 using c:(bound(column(c+1), column(c+2))) \
         with points pt 11 ps 1.6 lc rgb colour[k] notitle, \
       for [k = 1:3:2] '' index k-1 using c:(drawn(column(c+1), column(c+2))):(sprintf('%g', $3)) \
         with labels offset 0.6,0.7 left font ',9' tc rgb colour[k] notitle, \
       for [k = 1:6] NaN with linespoints pt mark[k] lc rgb colour[k] title curve[k], \
       NaN with points pt 11 ps 1.6 lc rgb '#444444' title 'at most this (within 1 s.e.)'
}
unset multiplot
