// The errors of quantities, a row each, in the order in which they act: NAME.cpp is error_NAME.cpp, which defines
// NAME_error.
REHEARSE_ERROR(scale)
REHEARSE_ERROR(misalignment)
REHEARSE_ERROR(cross_axis)
REHEARSE_ERROR(bias)
REHEARSE_ERROR(bias_walk)
REHEARSE_ERROR(offset)
REHEARSE_ERROR(index_error)
REHEARSE_ERROR(density)
REHEARSE_ERROR(stddev)
REHEARSE_ERROR(saturation)
REHEARSE_ERROR(counts)
REHEARSE_ERROR(quantum)
