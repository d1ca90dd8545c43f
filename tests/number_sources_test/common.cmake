include(${source}/cmake/number_sources.cmake)
physinv_refuse_numbers(sip/common/tables.cpp sip/common/metrics.cpp)
