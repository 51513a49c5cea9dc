! SPDX-License-Identifier: Apache-2.0
! A control space from Fortran: sources request edge lengths at some points, and the control space
! gives them at every point, before and after it is saved. The interfaces are those of
! controlspace.h that are used here.
module controlspace
  use, intrinsic :: iso_c_binding
  use, intrinsic :: iso_fortran_env, only: error_unit
  implicit none

  interface
    integer(c_int) function cspace_create(structure, domain, options, space) bind(c)
      import
      character(kind=c_char), intent(in) :: structure(*), options(*)
      real(c_double), intent(in) :: domain(6)
      type(c_ptr), intent(out) :: space
    end function

    subroutine cspace_free(space) bind(c)
      import
      type(c_ptr), value :: space
    end subroutine

    integer(c_int) function cspace_insert_lengths(space, n, positions, lengths) bind(c)
      import
      type(c_ptr), value :: space
      integer(c_size_t), value :: n
      real(c_double), intent(in) :: positions(3, n), lengths(n)
    end function

    integer(c_int) function cspace_grade(space, ratio) bind(c)
      import
      type(c_ptr), value :: space
      real(c_double), value :: ratio
    end function

    integer(c_int) function cspace_sample(space, n, positions, metrics) bind(c)
      import
      type(c_ptr), value :: space
      integer(c_size_t), value :: n
      real(c_double), intent(in) :: positions(3, n)
      real(c_double), intent(out) :: metrics(6, n)
    end function

    integer(c_int) function cspace_save(space, file) bind(c)
      import
      type(c_ptr), value :: space
      character(kind=c_char), intent(in) :: file(*)
    end function

    integer(c_int) function cspace_load(file, space) bind(c)
      import
      character(kind=c_char), intent(in) :: file(*)
      type(c_ptr), intent(out) :: space
    end function

    type(c_ptr) function cspace_last_error() bind(c)
      import
    end function

    integer(c_size_t) function strlen(text) bind(c)
      import
      type(c_ptr), value :: text
    end function
  end interface

contains

  ! What the last function that failed had to say.
  function last_error() result(text)
    character(len=:), allocatable :: text
    character(kind=c_char), pointer :: letters(:)
    integer :: i
    call c_f_pointer(cspace_last_error(), letters, [strlen(cspace_last_error())])
    allocate (character(len=size(letters)) :: text)
    do i = 1, size(letters)
      text(i:i) = letters(i)
    end do
  end function

  subroutine check(status)
    integer(c_int), intent(in) :: status
    if (status == 0) return
    write (error_unit, '(a)') last_error()
    error stop
  end subroutine

end module

program control_space
  use controlspace
  implicit none
  real(c_double), parameter :: domain(6) = [-1, -1, -1, 1, 1, 1]
  real(c_double), parameter :: positions(3, 2) = &
      reshape([0.3d0, 0.2d0, 0d0, -1d0, -1d0, -1d0], [3, 2])
  real(c_double), parameter :: lengths(2) = [0.02d0, 0.05d0]
  real(c_double), parameter :: places(3, 2) = &
      reshape([0.3d0, 0.2d0, 0d0, 0.9d0, 0.9d0, 0.9d0], [3, 2])
  real(c_double) :: metrics(6, 2), again(6, 2)
  type(c_ptr) :: space

  ! Leaves of a source are a tenth of its length: at the source, lengths are right to 2 %.
  call check(cspace_create('K_oV' // c_null_char, domain, 'tau=0.1' // c_null_char, space))
  call check(cspace_insert_lengths(space, 2_c_size_t, positions, lengths))
  call check(cspace_grade(space, 1.25d0))
  call check(cspace_sample(space, 2_c_size_t, places, metrics))
  print '(a, f6.3, a, f6.3)', 'length at the source: ', metrics(1, 1), ', far from it: ', &
      metrics(1, 2)

  call check(cspace_save(space, 'field-fortran.ctrl' // c_null_char))
  call cspace_free(space)
  call check(cspace_load('field-fortran.ctrl' // c_null_char, space))
  call check(cspace_sample(space, 2_c_size_t, places, again))
  call cspace_free(space)
  if (any(again /= metrics)) error stop 'another field after loading'
  print '(a)', 'the same after loading'

  ! What cannot be done says why.
  if (cspace_load('none.ctrl' // c_null_char, space) == 0) error stop 'a file that is not there'
  print '(a)', last_error()
end program
