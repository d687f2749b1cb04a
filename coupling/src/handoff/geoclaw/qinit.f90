! Surface and discharges that riprap handed over, for GeoClaw: eta.xyz, hu.xyz, hv.xyz beside this file.
!
! Cells within the raster have its depth and discharges, bilinearly between its centers; all others are at rest at sea_level.
subroutine qinit(meqn, mbc, mx, my, xlower, ylower, dx, dy, q, maux, aux)

    use geoclaw_module, only: sea_level

    implicit none

    integer, intent(in) :: meqn, mbc, mx, my, maux
    real(kind=8), intent(in) :: xlower, ylower, dx, dy
    real(kind=8), intent(inout) :: q(meqn, 1-mbc:mx+mbc, 1-mbc:my+mbc)
    real(kind=8), intent(inout) :: aux(maux, 1-mbc:mx+mbc, 1-mbc:my+mbc)

    ! of the raster, filled once
    integer, save :: n(2) = 0
    real(kind=8), save :: corner(2), side
    real(kind=8), allocatable, save :: field(:, :, :)

    integer :: i, j, k, a, b
    real(kind=8) :: x, y, place(2), share(2), value(3)

    if (n(1) == 0) call read_fields()
    q = 0.d0
    do j = 1, my
        do i = 1, mx
            q(1, i, j) = max(0.d0, sea_level - aux(1, i, j))
            x = xlower + (i - 0.5d0) * dx
            y = ylower + (j - 0.5d0) * dy
            place = (/ (x - corner(1)) / side, (y - corner(2)) / side /)
            if (any(place < 0.d0) .or. any(place > n - 1)) cycle
            a = min(int(place(1)), n(1) - 2)
            b = min(int(place(2)), n(2) - 2)
            share = place - (/ a, b /)
            do k = 1, 3
                value(k) = (1.d0 - share(2)) * ((1.d0 - share(1)) * field(k, a, b) + share(1) * field(k, a + 1, b)) &
                    + share(2) * ((1.d0 - share(1)) * field(k, a, b + 1) + share(1) * field(k, a + 1, b + 1))
            end do
            q(1, i, j) = max(0.d0, sea_level + value(1) - aux(1, i, j))
            if (q(1, i, j) > 0.d0) q(2:3, i, j) = value(2:3)
        end do
    end do

contains

    ! lines x y value from the north-west corner
    subroutine read_fields()
        integer, parameter :: unit = 77
        integer :: status, lines, row, column
        real(kind=8) :: first(2), at(2), z

        open(unit, file=datafile(1), status='old', action='read')
        lines = 0
        do
            read(unit, *, iostat=status) at, z
            if (status /= 0) exit
            if (lines == 0) first = at
            if (lines == 1) side = at(1) - first(1)
            if (at(2) == first(2)) n(1) = n(1) + 1
            lines = lines + 1
        end do
        close(unit)
        n(2) = lines / n(1)
        corner = (/ first(1), first(2) - (n(2) - 1) * side /)
        allocate(field(3, 0:n(1)-1, 0:n(2)-1))
        do k = 1, 3
            open(unit, file=datafile(k), status='old', action='read')
            do row = n(2) - 1, 0, -1
                do column = 0, n(1) - 1
                    read(unit, *) at, field(k, column, row)
                end do
            end do
            close(unit)
        end do
    end subroutine read_fields

    ! GeoClaw runs in its output folder, a folder below this one
    function datafile(k) result(path)
        integer, intent(in) :: k
        character(len=16) :: path
        character(len=7), parameter :: names(3) = (/ 'eta.xyz', 'hu.xyz ', 'hv.xyz ' /)
        logical :: is_here

        path = trim(names(k))
        inquire(file=path, exist=is_here)
        if (.not. is_here) path = '../' // trim(names(k))
    end function datafile

end subroutine qinit
