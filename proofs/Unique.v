(* At most one z(t) for each v(t) and start: two solutions never move apart, since dz/dt falls as z rises.

   That a solution exists is the hypothesis "motion"; it is not proved here. *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Stribeck Require Import Laws Motion Power Terms Continuous Relaxation Passive.
Open Scope R_scope.

Section Gronwall.
Context {U : UniformSpace}.
Variables (f : U -> R -> R) (ok : U -> Prop) (L : R).
(* one-sided Lipschitz, all that Gronwall's argument needs *)
Hypothesis one_sided : forall w x y, ok w -> (x - y) * (f w x - f w y) <= L * ((x - y) * (x - y)).

Definition gap (z y : R -> R) (t : R) : R := (z t - y t) * (z t - y t).

Lemma piece_sub (u : R -> U) z a b c d : piece f u z a b -> a <= c -> c < d -> d <= b -> piece f u z c d.
Proof.
  intros [Hab (u' & z' & Hu & Hz & E & Hd)] H1 H2 H3. split; [exact H2|]. exists u', z'.
  split; [exact Hu|]. split; [exact Hz|]. split; intros t Ht; [apply E; lra|apply Hd; lra].
Qed.

Lemma motion_split (u : R -> U) z a c : motion f u z a c -> forall b, a <= b <= c ->
  motion f u z a b /\ motion f u z b c.
Proof.
  intros M. induction M as [a | a m c M IH P]; intros b Hb.
  - replace b with a by lra. split; apply at_once.
  - assert (Hmc : m < c) by apply P. assert (Ham := motion_le _ _ _ _ _ M). destruct (Rle_lt_dec b m) as [H | H].
    + destruct (IH b) as [M1 M2]; [lra|]. split; [exact M1|]. apply onward with m; assumption.
    + split.
      * apply onward with m; [exact M|]. apply (piece_sub u z m c); auto; lra.
      * destruct (Rle_lt_or_eq_dec b c (proj2 Hb)) as [K | ->]; [|apply at_once].
        apply motion_of_piece. apply (piece_sub u z m c); auto; lra.
Qed.

Lemma gap_piece (u : R -> U) z y a b : piece f u z a b -> piece f u y a b -> (forall t, a <= t <= b -> ok (u t)) ->
  gap z y b * exp (- (2 * L * b)) <= gap z y a * exp (- (2 * L * a)).
Proof.
  intros [Hab (u1 & z' & _ & Hz & Ez & Hdz)] [_ (u2 & y' & _ & Hy & Ey & Hdy)] Hok.
  unfold gap. rewrite !Ez, !Ey by lra. set (h := fun t => (z' t - y' t) * (z' t - y' t) * exp (- (2 * L * t))).
  enough (- h a <= - h b) by (unfold h in *; lra).
  set (d := fun t => f (u t) (z t) - f (u t) (y t)).
  assert (Ce : forall t, is_derive (fun t => exp (- (2 * L * t))) t (- (2 * L) * exp (- (2 * L * t)))).
  { intros t. auto_derive; [exact I|ring]. }
  apply (grows (fun t => - h t) (fun t => - ((2 * ((z' t - y' t) * d t) - 2 * L * ((z' t - y' t) * (z' t - y' t))) * exp (- (2 * L * t))))).
  - lra.
  - intros t _. apply (continuous_opp h). apply (continuous_mult (fun t => (z' t - y' t) * (z' t - y' t)) (fun t => exp (- (2 * L * t)))).
    + apply (continuous_mult (fun t => z' t - y' t) (fun t => z' t - y' t)); apply (continuous_minus z' y'); auto.
    + apply (is_derive_continuous _ _ _ (Ce t)).
  - intros t Ht. destruct (Hdz t Ht) as [_ D1]. destruct (Hdy t Ht) as [_ D2].
    apply (near z z' a b) in D1; [|exact Ez|exact Ht]. apply (near y y' a b) in D2; [|exact Ey|exact Ht].
    assert (D : is_derive (fun t => z' t - y' t) t (d t)) by (apply (is_derive_minus z' y'); assumption).
    apply (is_derive_opp h). evar_last.
    + apply (is_derive_mult (fun t => (z' t - y' t) * (z' t - y' t)) (fun t => exp (- (2 * L * t)))).
      * apply (is_derive_mult (fun t => z' t - y' t) (fun t => z' t - y' t) t (d t) (d t) D D). intros; apply Rmult_comm.
      * apply Ce.
      * intros; apply Rmult_comm.
    + unfold plus, mult; simpl. unfold mult; simpl. ring.
  - intros t Ht. pose proof (exp_pos (- (2 * L * t))). pose proof (one_sided (u t) (z t) (y t) (Hok t ltac:(lra))) as O.
    fold (d t) in O. rewrite Ez, Ey in O by lra. nra.
Qed.

Lemma gap_mixed (u : R -> U) z y a b : motion f u y a b -> forall c, b <= c -> piece f u z a c -> (forall t, a <= t <= b -> ok (u t)) ->
  gap z y b * exp (- (2 * L * b)) <= gap z y a * exp (- (2 * L * a)).
Proof.
  intros M. induction M as [a | a m b M IH P]; intros c Hc Pz Hok; [lra|].
  assert (Hmb : m < b) by apply P. assert (Ham := motion_le _ _ _ _ _ M).
  apply Rle_trans with (gap z y m * exp (- (2 * L * m))).
  - apply gap_piece with u; auto; [apply (piece_sub u z a c); auto; lra|]. intros t Ht. apply Hok. lra.
  - apply IH with c; auto; [lra|]. intros t Ht. apply Hok. lra.
Qed.

Lemma gap_bound (u : R -> U) z y a b : motion f u z a b -> motion f u y a b -> (forall t, a <= t <= b -> ok (u t)) ->
  gap z y b * exp (- (2 * L * b)) <= gap z y a * exp (- (2 * L * a)).
Proof.
  intros Mz. induction Mz as [a | a m b Mz IH P]; intros My Hok; [lra|].
  assert (Hmb : m < b) by apply P. assert (Ham := motion_le _ _ _ _ _ Mz).
  destruct (motion_split u y a b My m) as [My1 My2]; [lra|].
  apply Rle_trans with (gap z y m * exp (- (2 * L * m))).
  - apply (gap_mixed u z y m b My2 b); auto; [lra|]. intros t Ht. apply Hok. lra.
  - apply IH; auto. intros t Ht. apply Hok. lra.
Qed.

(* Gronwall's inequality for two motions with the same input. *)
Theorem gronwall (u : R -> U) z y a b : motion f u z a b -> motion f u y a b -> (forall t, a <= t <= b -> ok (u t)) ->
  gap z y b <= gap z y a * exp (2 * L * (b - a)).
Proof.
  intros Mz My Hok. pose proof (gap_bound u z y a b Mz My Hok) as G.
  apply Rmult_le_reg_r with (exp (- (2 * L * b))); [apply exp_pos|].
  rewrite (Rmult_assoc (gap z y a)), <- exp_plus. replace (2 * L * (b - a) + - (2 * L * b)) with (- (2 * L * a)) by ring. exact G.
Qed.

Theorem unique (u : R -> U) z y a b : motion f u z a b -> motion f u y a b -> (forall t, a <= t <= b -> ok (u t)) ->
  z a = y a -> forall t, a <= t <= b -> z t = y t.
Proof.
  intros Mz My Hok E t Ht. destruct (motion_split u z a b Mz t Ht) as [Mz' _]. destruct (motion_split u y a b My t Ht) as [My' _].
  assert (G : gap z y t <= gap z y a * exp (2 * L * (t - a))).
  { apply gronwall with u; auto. intros s Hs. apply Hok. lra. }
  unfold gap in G. rewrite E in G. replace ((y a - y a) * (y a - y a)) with 0 in G by ring. rewrite Rmult_0_l in G.
  assert (z t - y t = 0) by nra. lra.
Qed.
End Gronwall.

(* dz/dt does not rise with z: two solutions do not move apart, whatever the velocity. *)
Definition falling {U : UniformSpace} (f : U -> R -> R) (ok : U -> Prop) : Prop :=
  forall w x y, ok w -> (x - y) * (f w x - f w y) <= 0.
Definition contracting (dz : R -> R -> R) : Prop :=
  forall v z y a b, motion (U := R_UniformSpace) dz v z a b -> motion (U := R_UniformSpace) dz v y a b ->
  Rabs (z b - y b) <= Rabs (z a - y a).
Definition at_most_one (dz : R -> R -> R) : Prop :=
  forall v z y a b, motion (U := R_UniformSpace) dz v z a b -> motion (U := R_UniformSpace) dz v y a b ->
  z a = y a -> forall t, a <= t <= b -> z t = y t.

Lemma falling_contracting dz : falling (U := R_UniformSpace) dz any -> contracting dz.
Proof.
  intros H v z y a b Mz My. assert (H0 : forall w x y, @any R w -> (x - y) * (dz w x - dz w y) <= 0 * ((x - y) * (x - y))).
  { intros w x x' Hw. rewrite Rmult_0_l. apply H. exact Hw. }
  pose proof (gronwall (U := R_UniformSpace) dz any 0 H0 v z y a b Mz My (fun _ _ => I)) as G.
  unfold gap in G. replace (2 * 0 * (b - a)) with 0 in G by ring. rewrite exp_0, Rmult_1_r in G.
  apply Rsqr_le_abs_0. exact G.
Qed.

Lemma falling_unique dz : falling (U := R_UniformSpace) dz any -> at_most_one dz.
Proof.
  intros H v z y a b Mz My E. apply (unique (U := R_UniformSpace) dz any 0) with (u := v); auto.
  - intros w x x' Hw. rewrite Rmult_0_l. apply H. exact Hw.
  - intros. exact I.
Qed.

(* --- the laws -------------------------------------------------------------------------------------------------------------- *)

(* x share(x) rises where the share rises with |x|. *)
Definition rising_share (s : R -> R) : Prop :=
  (forall x, 0 <= s x) /\ (forall x y, 0 <= y <= x -> s y <= s x) /\ (forall x y, x <= y <= 0 -> s y <= s x).

Lemma rising_product s x y : rising_share s -> 0 <= (x - y) * (s x * x - s y * y).
Proof.
  intros (H0 & Hp & Hn).
  assert (K : forall x y, y <= x -> s y * y <= s x * x).
  { intros a b Hab. destruct (Rle_lt_dec 0 b) as [B | B].
    - apply Rmult_le_compat; auto; apply Hp; lra.
    - destruct (Rle_lt_dec a 0) as [A | A].
      + pose proof (Hn b a (conj Hab A)). pose proof (H0 a). pose proof (H0 b). nra.
      + pose proof (H0 a). pose proof (H0 b). nra. }
  destruct (Rle_lt_dec y x) as [L | L]; [pose proof (K x y L)|pose proof (K y x (Rlt_le _ _ L))]; nra.
Qed.

Lemma falling_of (dz : R -> R -> R) (k : R -> R) (mu : R -> R) (s : R -> R -> R) : (forall v, 0 <= k v) ->
  (forall v, rising_share (s v)) -> (forall v z, dz v z = mu v - k v * (s v z * z)) ->
  falling (U := R_UniformSpace) dz any.
Proof.
  intros Hk Hs E v x y _. rewrite !E. pose proof (rising_product (s v) x y (Hs v)). specialize (Hk v).
  replace ((x - y) * (mu v - k v * (s v x * x) - (mu v - k v * (s v y * y))))
    with (- (k v * ((x - y) * (s v x * x - s v y * y)))) by ring. nra.
Qed.

Lemma rising_one : rising_share (fun _ => 1).
Proof. repeat split; intros; lra. Qed.

Lemma yielded_mono p v x y : z_ba p < g p v -> Rabs y <= Rabs x -> yielded p v y <= yielded p v x.
Proof. intros H L. unfold yielded. apply Rmult_le_compat_r; [apply Rlt_le, Rinv_0_lt_compat|]; lra. Qed.

Lemma rising_a p v : z_ba p < g p v -> rising_share (a p v).
Proof.
  intros H. split; [intros x; rewrite a_is; apply smoothstep_range|].
  split; intros x y Hxy; rewrite !a_is; apply smoothstep_mono, yielded_mono; auto.
  - rewrite !Rabs_pos_eq; lra.
  - rewrite !Rabs_left1; lra.
Qed.

Lemma rising_alpha_0 p v : z_ba p < g p v -> rising_share (alpha_0 p v).
Proof.
  intros H. split; [intros x; rewrite alpha_0_is by exact H; apply sine_step_range|].
  split; intros x y Hxy; rewrite !alpha_0_is by exact H; apply sine_step_mono, yielded_mono; auto.
  - rewrite !Rabs_pos_eq; lra.
  - rewrite !Rabs_left1; lra.
Qed.

Lemma rising_alpha p v : z_ba p < g p v -> rising_share (alpha p v).
Proof.
  intros H. destruct (rising_alpha_0 p v H) as (H0 & Hp & Hn). unfold alpha. split; [|split].
  - intros x. destruct (Rle_dec (v * x) 0); [lra|apply H0].
  - intros x y Hxy. destruct (Rle_dec (v * y) 0) as [Y | Y], (Rle_dec (v * x) 0) as [X | X]; try lra; auto.
    exfalso. apply Y. destruct (Rle_lt_dec v 0); nra.
  - intros x y Hxy. destruct (Rle_dec (v * y) 0) as [Y | Y], (Rle_dec (v * x) 0) as [X | X]; try lra; auto.
    exfalso. apply Y. destruct (Rle_lt_dec v 0); nra.
Qed.

Lemma v_S_0_nonneg p v : 0 < k_v p -> 0 <= v * S_0 p v.
Proof.
  intros Hk. unfold S_0. pose proof PI_RGT_0. assert (C : 0 <= 2 / PI) by (apply Rlt_le, Rdiv_lt_0_compat; lra).
  replace (v * (2 / PI * atan (k_v p * v))) with (2 / PI * (v * atan (k_v p * v))) by ring. apply Rmult_le_pos; [exact C|].
  destruct (Rle_lt_dec 0 v) as [V | V].
  - apply Rmult_le_pos; [exact V|]. apply atan_nonneg. nra.
  - assert (0 <= atan (- (k_v p * v))) by (apply atan_nonneg; nra). rewrite atan_opp in H0. nra.
Qed.

Ltac nonneg_factor p v := first [ apply Rabs_pos | apply v_S_0_nonneg; assumption
  | apply Rle_trans with (1 := Rabs_pos v);
    first [apply (m_atan_majorant p v) | apply (m_sqrt_majorant p v) | apply (m_compact_majorant p v)]; assumption ].

Lemma lugre_falling p : lugre.allowed p -> falling (U := R_UniformSpace) (lugre.dz_dt p) any.
Proof.
  intros H. unfold lugre.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  apply (falling_of _ (fun v => Rabs v / g p v) (fun v => v) (fun _ _ => 1)); [intros v|intros v; apply rising_one|intros v z].
  - apply Rmult_le_pos; [nonneg_factor p v|apply Rlt_le, Rinv_0_lt_compat, g_pos; assumption].
  - unfold lugre.dz_dt. field. apply Rgt_not_eq, Rlt_gt, g_pos; assumption.
Qed.
Theorem lugre_contracting p : lugre.allowed p -> contracting (lugre.dz_dt p).
Proof. intros H. apply falling_contracting, lugre_falling, H. Qed.
Theorem lugre_unique p : lugre.allowed p -> at_most_one (lugre.dz_dt p).
Proof. intros H. apply falling_unique, lugre_falling, H. Qed.

Lemma lugre_arctan_falling p : lugre_arctan.allowed p -> falling (U := R_UniformSpace) (lugre_arctan.dz_dt p) any.
Proof.
  intros H. unfold lugre_arctan.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  apply (falling_of _ (fun v => v * S_0 p v / g p v) (fun v => v) (fun _ _ => 1)); [intros v|intros v; apply rising_one|intros v z].
  - apply Rmult_le_pos; [nonneg_factor p v|apply Rlt_le, Rinv_0_lt_compat, g_pos; assumption].
  - unfold lugre_arctan.dz_dt. field. apply Rgt_not_eq, Rlt_gt, g_pos; assumption.
Qed.
Theorem lugre_arctan_contracting p : lugre_arctan.allowed p -> contracting (lugre_arctan.dz_dt p).
Proof. intros H. apply falling_contracting, lugre_arctan_falling, H. Qed.
Theorem lugre_arctan_unique p : lugre_arctan.allowed p -> at_most_one (lugre_arctan.dz_dt p).
Proof. intros H. apply falling_unique, lugre_arctan_falling, H. Qed.

Lemma lugre_sobczyk_falling p : lugre_sobczyk.allowed p -> falling (U := R_UniformSpace) (lugre_sobczyk.dz_dt p) any.
Proof.
  intros H. unfold lugre_sobczyk.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  apply (falling_of _ (fun v => v * S_0 p v / g p v) (fun v => S_0 p v * S_0 p v * v) (fun _ _ => 1)); [intros v|intros v; apply rising_one|intros v z].
  - apply Rmult_le_pos; [nonneg_factor p v|apply Rlt_le, Rinv_0_lt_compat, g_pos; assumption].
  - unfold lugre_sobczyk.dz_dt. field. apply Rgt_not_eq, Rlt_gt, g_pos; assumption.
Qed.
Theorem lugre_sobczyk_contracting p : lugre_sobczyk.allowed p -> contracting (lugre_sobczyk.dz_dt p).
Proof. intros H. apply falling_contracting, lugre_sobczyk_falling, H. Qed.
Theorem lugre_sobczyk_unique p : lugre_sobczyk.allowed p -> at_most_one (lugre_sobczyk.dz_dt p).
Proof. intros H. apply falling_unique, lugre_sobczyk_falling, H. Qed.

Lemma lugre_majorant_falling p : lugre_majorant.allowed p -> falling (U := R_UniformSpace) (lugre_majorant.dz_dt p) any.
Proof.
  intros H. unfold lugre_majorant.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  apply (falling_of _ (fun v => m_atan p v / g p v) (fun v => v) (fun _ _ => 1)); [intros v|intros v; apply rising_one|intros v z].
  - apply Rmult_le_pos; [nonneg_factor p v|apply Rlt_le, Rinv_0_lt_compat, g_pos; assumption].
  - unfold lugre_majorant.dz_dt. field. apply Rgt_not_eq, Rlt_gt, g_pos; assumption.
Qed.
Theorem lugre_majorant_contracting p : lugre_majorant.allowed p -> contracting (lugre_majorant.dz_dt p).
Proof. intros H. apply falling_contracting, lugre_majorant_falling, H. Qed.
Theorem lugre_majorant_unique p : lugre_majorant.allowed p -> at_most_one (lugre_majorant.dz_dt p).
Proof. intros H. apply falling_unique, lugre_majorant_falling, H. Qed.

Lemma lugre_majorant_sqrt_falling p : lugre_majorant_sqrt.allowed p -> falling (U := R_UniformSpace) (lugre_majorant_sqrt.dz_dt p) any.
Proof.
  intros H. unfold lugre_majorant_sqrt.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  apply (falling_of _ (fun v => m_sqrt p v / g p v) (fun v => v) (fun _ _ => 1)); [intros v|intros v; apply rising_one|intros v z].
  - apply Rmult_le_pos; [nonneg_factor p v|apply Rlt_le, Rinv_0_lt_compat, g_pos; assumption].
  - unfold lugre_majorant_sqrt.dz_dt. field. apply Rgt_not_eq, Rlt_gt, g_pos; assumption.
Qed.
Theorem lugre_majorant_sqrt_contracting p : lugre_majorant_sqrt.allowed p -> contracting (lugre_majorant_sqrt.dz_dt p).
Proof. intros H. apply falling_contracting, lugre_majorant_sqrt_falling, H. Qed.
Theorem lugre_majorant_sqrt_unique p : lugre_majorant_sqrt.allowed p -> at_most_one (lugre_majorant_sqrt.dz_dt p).
Proof. intros H. apply falling_unique, lugre_majorant_sqrt_falling, H. Qed.

Lemma lugre_majorant_compact_falling p : lugre_majorant_compact.allowed p -> falling (U := R_UniformSpace) (lugre_majorant_compact.dz_dt p) any.
Proof.
  intros H. unfold lugre_majorant_compact.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  apply (falling_of _ (fun v => m_compact p v / g p v) (fun v => v) (fun _ _ => 1)); [intros v|intros v; apply rising_one|intros v z].
  - apply Rmult_le_pos; [nonneg_factor p v|apply Rlt_le, Rinv_0_lt_compat, g_pos; assumption].
  - unfold lugre_majorant_compact.dz_dt. field. apply Rgt_not_eq, Rlt_gt, g_pos; assumption.
Qed.
Theorem lugre_majorant_compact_contracting p : lugre_majorant_compact.allowed p -> contracting (lugre_majorant_compact.dz_dt p).
Proof. intros H. apply falling_contracting, lugre_majorant_compact_falling, H. Qed.
Theorem lugre_majorant_compact_unique p : lugre_majorant_compact.allowed p -> at_most_one (lugre_majorant_compact.dz_dt p).
Proof. intros H. apply falling_unique, lugre_majorant_compact_falling, H. Qed.

Lemma elastoplastic_falling p : elastoplastic.allowed p -> falling (U := R_UniformSpace) (elastoplastic.dz_dt p) any.
Proof.
  intros H. unfold elastoplastic.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  apply (falling_of _ (fun v => Rabs v / g p v) (fun v => v) (alpha p)); [intros v|intros v; apply rising_alpha, z_ba_below; assumption|intros v z].
  - apply Rmult_le_pos; [nonneg_factor p v|apply Rlt_le, Rinv_0_lt_compat, g_pos; assumption].
  - unfold elastoplastic.dz_dt. field. apply Rgt_not_eq, Rlt_gt, g_pos; assumption.
Qed.
Theorem elastoplastic_contracting p : elastoplastic.allowed p -> contracting (elastoplastic.dz_dt p).
Proof. intros H. apply falling_contracting, elastoplastic_falling, H. Qed.
Theorem elastoplastic_unique p : elastoplastic.allowed p -> at_most_one (elastoplastic.dz_dt p).
Proof. intros H. apply falling_unique, elastoplastic_falling, H. Qed.

Lemma elastoplastic_sobczyk_falling p : elastoplastic_sobczyk.allowed p -> falling (U := R_UniformSpace) (elastoplastic_sobczyk.dz_dt p) any.
Proof.
  intros H. unfold elastoplastic_sobczyk.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  apply (falling_of _ (fun v => v * S_0 p v / g p v) (fun v => S_0 p v * S_0 p v * v) (alpha_0 p)); [intros v|intros v; apply rising_alpha_0, z_ba_below; assumption|intros v z].
  - apply Rmult_le_pos; [nonneg_factor p v|apply Rlt_le, Rinv_0_lt_compat, g_pos; assumption].
  - unfold elastoplastic_sobczyk.dz_dt. field. apply Rgt_not_eq, Rlt_gt, g_pos; assumption.
Qed.
Theorem elastoplastic_sobczyk_contracting p : elastoplastic_sobczyk.allowed p -> contracting (elastoplastic_sobczyk.dz_dt p).
Proof. intros H. apply falling_contracting, elastoplastic_sobczyk_falling, H. Qed.
Theorem elastoplastic_sobczyk_unique p : elastoplastic_sobczyk.allowed p -> at_most_one (elastoplastic_sobczyk.dz_dt p).
Proof. intros H. apply falling_unique, elastoplastic_sobczyk_falling, H. Qed.

Lemma elastoplastic_majorant_falling p : elastoplastic_majorant.allowed p -> falling (U := R_UniformSpace) (elastoplastic_majorant.dz_dt p) any.
Proof.
  intros H. unfold elastoplastic_majorant.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  apply (falling_of _ (fun v => m_atan p v / g p v) (fun v => v) (a p)); [intros v|intros v; apply rising_a, z_ba_below; assumption|intros v z].
  - apply Rmult_le_pos; [nonneg_factor p v|apply Rlt_le, Rinv_0_lt_compat, g_pos; assumption].
  - unfold elastoplastic_majorant.dz_dt. field. apply Rgt_not_eq, Rlt_gt, g_pos; assumption.
Qed.
Theorem elastoplastic_majorant_contracting p : elastoplastic_majorant.allowed p -> contracting (elastoplastic_majorant.dz_dt p).
Proof. intros H. apply falling_contracting, elastoplastic_majorant_falling, H. Qed.
Theorem elastoplastic_majorant_unique p : elastoplastic_majorant.allowed p -> at_most_one (elastoplastic_majorant.dz_dt p).
Proof. intros H. apply falling_unique, elastoplastic_majorant_falling, H. Qed.

Lemma elastoplastic_majorant_sqrt_falling p : elastoplastic_majorant_sqrt.allowed p -> falling (U := R_UniformSpace) (elastoplastic_majorant_sqrt.dz_dt p) any.
Proof.
  intros H. unfold elastoplastic_majorant_sqrt.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  apply (falling_of _ (fun v => m_sqrt p v / g p v) (fun v => v) (a p)); [intros v|intros v; apply rising_a, z_ba_below; assumption|intros v z].
  - apply Rmult_le_pos; [nonneg_factor p v|apply Rlt_le, Rinv_0_lt_compat, g_pos; assumption].
  - unfold elastoplastic_majorant_sqrt.dz_dt. field. apply Rgt_not_eq, Rlt_gt, g_pos; assumption.
Qed.
Theorem elastoplastic_majorant_sqrt_contracting p : elastoplastic_majorant_sqrt.allowed p -> contracting (elastoplastic_majorant_sqrt.dz_dt p).
Proof. intros H. apply falling_contracting, elastoplastic_majorant_sqrt_falling, H. Qed.
Theorem elastoplastic_majorant_sqrt_unique p : elastoplastic_majorant_sqrt.allowed p -> at_most_one (elastoplastic_majorant_sqrt.dz_dt p).
Proof. intros H. apply falling_unique, elastoplastic_majorant_sqrt_falling, H. Qed.

Lemma elastoplastic_majorant_compact_falling p : elastoplastic_majorant_compact.allowed p -> falling (U := R_UniformSpace) (elastoplastic_majorant_compact.dz_dt p) any.
Proof.
  intros H. unfold elastoplastic_majorant_compact.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  apply (falling_of _ (fun v => m_compact p v / g p v) (fun v => v) (a p)); [intros v|intros v; apply rising_a, z_ba_below; assumption|intros v z].
  - apply Rmult_le_pos; [nonneg_factor p v|apply Rlt_le, Rinv_0_lt_compat, g_pos; assumption].
  - unfold elastoplastic_majorant_compact.dz_dt. field. apply Rgt_not_eq, Rlt_gt, g_pos; assumption.
Qed.
Theorem elastoplastic_majorant_compact_contracting p : elastoplastic_majorant_compact.allowed p -> contracting (elastoplastic_majorant_compact.dz_dt p).
Proof. intros H. apply falling_contracting, elastoplastic_majorant_compact_falling, H. Qed.
Theorem elastoplastic_majorant_compact_unique p : elastoplastic_majorant_compact.allowed p -> at_most_one (elastoplastic_majorant_compact.dz_dt p).
Proof. intros H. apply falling_unique, elastoplastic_majorant_compact_falling, H. Qed.

Lemma dahl_falling p : dahl.allowed p -> falling (U := R_UniformSpace) (dahl.dz_dt p) any.
Proof.
  intros H. destruct (dahl_factor p H) as (_ & _ & _ & _ & E).
  apply (falling_of _ (fun v => sigma_0 p / F_c p * Rabs v) (fun v => v) (fun _ _ => 1)); [intros v|intros v; apply rising_one|intros v z].
  - apply Rmult_le_pos; [lra|apply Rabs_pos].
  - unfold dahl.dz_dt. ring.
Qed.
Theorem dahl_contracting p : dahl.allowed p -> contracting (dahl.dz_dt p).
Proof. intros H. apply falling_contracting, dahl_falling, H. Qed.
Theorem dahl_unique p : dahl.allowed p -> at_most_one (dahl.dz_dt p).
Proof. intros H. apply falling_unique, dahl_falling, H. Qed.
